/// Damaged scenes: whatever the text, it parses or it is a ParameterError of ours; deal.II never has to complain.

#include "scene/parameter_file.h"

#include <gtest/gtest.h>

#include <random>

namespace kerf::scene::parameter_file_fuzz_test {
namespace {

struct Fields {
  double edge = 0.1;
  std::string name = "liver";
  Points path;

  void describe(Parameters& p) {
    p.number("Edge [m]", edge, positive, "Length.");
    p.text("Name", name, "Any text.");
    p.points("Path", path, "Points.");
  }
};

const std::string sound =
  "subsection Body liver # a body\n  set Edge [m] = 0.005\n  set Name = a = b\n"
  "  subsection Inner\n    set Path = 1, 2, 3; \\\n    4, 5, 6\n  end\nend\n";

std::vector<SectionKind> grammar() {
  return {{"Body", Occurrence::named, "", keys_of<Fields>(), {{"Inner", Occurrence::once, "", keys_of<Fields>(), {}}}}};
}

/// Replaces, removes or inserts a few pieces.
std::string damaged(std::string text, std::mt19937& random) {
  const std::vector<std::string> pieces = {"\n", "\\",          "#", "=",    "end", "set ", "subsection ", " ",
                                           "\t", "/",           "[", "\r\n", "x",   "\"",   "{1|2}",       ".",
                                           "$",  "include a\n", ",", ";",    "0",   ""};
  for (int n = std::uniform_int_distribution<int>(1, 3)(random); n > 0; --n) {
    const auto at = std::uniform_int_distribution<std::size_t>(0, text.size())(random);
    const auto n_removed = std::uniform_int_distribution<std::size_t>(0, 3)(random);
    text.replace(at, n_removed, pieces[std::uniform_int_distribution<std::size_t>(0, pieces.size() - 1)(random)]);
  }
  return text;
}

TEST(ParameterFileFuzz, DamagedScenesParseOrAreOurErrors) {
  std::mt19937 random(7);
  int n_parsed = 0, n_refused = 0;
  for (int i = 0; i < 20000; ++i) {
    const std::string text = damaged(sound, random);
    try {
      const Section scene = parse_scene(scan_scene_text(text, "a.prm"), grammar());
      for (const auto* body : scene.all("Body"))
        body->read<Fields>();
      ASSERT_EQ(effective_text(parse_scene(scan_scene_text(effective_text(scene), "b.prm"), grammar())),
                effective_text(scene))
        << text;
      ++n_parsed;
    } catch (const ParameterError& error) {
      ASSERT_EQ(error.complaint().file, "a.prm") << error.what() << "\n" << text;
      ASSERT_GT(error.complaint().line, 0) << error.what() << "\n" << text;
      ++n_refused;
    }
  }
  EXPECT_GT(n_parsed, 500);
  EXPECT_GT(n_refused, 500);
}

} // namespace
} // namespace kerf::scene::parameter_file_fuzz_test
