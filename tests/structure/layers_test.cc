/// What goodwill does not keep: which room includes which, no include cycles, heavy headers in their rooms, no function
/// that ends the process, no file too long to read. A new room gets a row in `rooms`.

#include "tests/support/checkout.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace kerf::layers_test {
namespace {

using Names = std::vector<std::string>;

struct Room {
  std::string name;
  Names uses;
};

/// Ground floor first: a room uses only rooms before it.
const std::vector<Room> rooms = {
  {"base", {}},
  {"geometry", {"base"}},
  {"grid", {"base"}},
  {"cut", {"base", "geometry", "grid"}},
  {"surface", {"base", "grid"}},
  {"material", {"base"}},
  {"dynamics", {"base"}},
  {"fem", {"base", "grid", "material", "dynamics"}},
  {"lattice", {"base", "grid", "material", "dynamics"}},
  {"spring", {"base", "grid", "dynamics"}},
  {"pba", {"base", "grid", "material", "dynamics"}},
  {"gl", {"base"}},
  {"visibility", {"base", "geometry", "gl", "pba"}},
  {"physics",
   {"base", "grid", "surface", "material", "dynamics", "fem", "lattice", "spring", "pba", "visibility"}},
  {"image", {"base"}},
  {"warp", {"base", "image"}},
  {"texture", {"base", "geometry", "image", "warp"}},
  {"render", {"base", "gl"}},
  {"output", {"base"}},
  {"reference", {"base"}},
  {"scene",
   {"base", "geometry", "grid", "cut", "surface", "material", "dynamics", "fem", "lattice", "spring", "pba", "visibility",
    "physics", "gl", "image", "warp", "texture", "render", "output"}},
  {"study", {"base", "material", "output", "reference", "scene"}},
  {"bench", {"base", "surface", "dynamics", "image", "output", "scene"}},
};

/// Headers that only some rooms may see.
struct Heavy {
  std::string prefix;
  Names rooms;
};
const std::vector<Heavy> heavy_headers = {
  {"deal.II/", {"dynamics", "fem", "reference", "scene"}},
  {"CGAL/", {"geometry"}},
  {"hdf5", {"output"}},
  {"H5", {"output"}},
  {"GL/", {"gl"}},
  {"EGL/", {"gl"}},
  {"GLES", {"gl"}},
  {"jpeglib", {"image"}},
  {"png.h", {"image", "render"}},
};

const Names ends_of_process = {"abort", "exit", "_exit", "_Exit", "quick_exit", "terminate"};

constexpr int max_lines = 500;

struct Source {
  std::string path; // below src: "cut/blade.h"
  std::string text;
};

struct Line {
  std::string place; // "src/cut/blade.h:3"
  std::string text;
};

bool contains(const Names& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string room_of(const std::string& path) { return path.substr(0, path.find('/')); }

const Room* find_room(const std::string& name) {
  const auto it = std::find_if(rooms.begin(), rooms.end(), [&](const Room& room) { return room.name == name; });
  return it == rooms.end() ? nullptr : &*it;
}

std::vector<Line> lines_of(const Source& source) {
  std::vector<Line> lines;
  std::istringstream in(source.text);
  for (std::string text; std::getline(in, text);)
    lines.push_back({"src/" + source.path + ":" + std::to_string(lines.size() + 1), text});
  return lines;
}

std::string without_blanks(std::string text) {
  std::erase_if(text, [](const unsigned char c) { return std::isspace(c); });
  return text;
}

/// What stands between the quotes of an #include; empty if the line is none.
std::string included(const std::string& line, const char open_quote, const char close_quote) {
  const std::string text = without_blanks(line), start = std::string("#include") + open_quote;
  if (!text.starts_with(start))
    return "";
  return text.substr(start.size(), text.find(close_quote, start.size()) - start.size());
}
std::string own_header(const std::string& line) { return included(line, '"', '"'); }
std::string foreign_header(const std::string& line) { return included(line, '<', '>'); }

void check_own_header(const Room& room, const Line& line, const std::string& header, Names& found) {
  const std::string used = room_of(header);
  if (!find_room(used))
    found.push_back(line.place + ": \"" + header + "\" is in no room");
  else if (used != room.name && !contains(room.uses, used))
    found.push_back(line.place + ": " + room.name + " may not include " + used + " (\"" + header + "\")");
}

void check_foreign_header(const Room& room, const Line& line, const std::string& header, Names& found) {
  for (const auto& heavy : heavy_headers)
    if (header.starts_with(heavy.prefix) && !contains(heavy.rooms, room.name))
      found.push_back(line.place + ": " + room.name + " may not include <" + header + ">");
}

/// The names that stand before an opening parenthesis: of functions, free or in a namespace, not of members.
Names calls(const std::string& code) {
  const auto in_name = [](const unsigned char c) { return std::isalnum(c) || c == '_'; };
  Names found;
  for (auto open = code.find('('); open != std::string::npos; open = code.find('(', open + 1)) {
    std::size_t end = open;
    while (end > 0 && code[end - 1] == ' ')
      --end;
    std::size_t begin = end;
    while (begin > 0 && in_name(code[begin - 1]))
      --begin;
    const char before = begin > 0 ? code[begin - 1] : ' ';
    if (before != '.' && before != '>')
      found.push_back(code.substr(begin, end - begin));
  }
  return found;
}

void check_no_exit(const Line& line, Names& found) {
  const std::string code = line.text.substr(0, line.text.find("//"));
  for (const auto& name : calls(code))
    if (contains(ends_of_process, name))
      found.push_back(line.place + ": a library may not end the process: " + code);
}

void check_file(const Source& source, Names& found) {
  const auto* room = find_room(room_of(source.path));
  if (!room) {
    found.push_back("src/" + source.path + ":1: the room is not in the table of this test");
    return;
  }
  const auto lines = lines_of(source);
  for (const auto& line : lines) {
    if (const auto header = own_header(line.text); !header.empty())
      check_own_header(*room, line, header, found);
    if (const auto header = foreign_header(line.text); !header.empty())
      check_foreign_header(*room, line, header, found);
    check_no_exit(line, found);
  }
  if (lines.size() > max_lines)
    found.push_back(lines.back().place + ": a file may have at most " + std::to_string(max_lines) + " lines");
}

/// Depth-first search; an include of a file that is still open closes a cycle.
class CycleSearch {
 public:
  explicit CycleSearch(const std::vector<Source>& sources) {
    for (const auto& source : sources)
      lines_[source.path] = lines_of(source);
  }

  Names cycles() {
    for (const auto& [path, lines] : lines_)
      visit(path);
    return found_;
  }

 private:
  void visit(const std::string& path) {
    if (contains(done_, path))
      return;
    open_.push_back(path);
    for (const auto& line : lines_.at(path)) {
      const std::string header = own_header(line.text);
      if (contains(open_, header))
        found_.push_back(line.place + ": closes an include cycle: " + chain_from(header) + header);
      else if (lines_.count(header))
        visit(header);
    }
    open_.pop_back();
    done_.push_back(path);
  }

  std::string chain_from(const std::string& header) const {
    std::string chain;
    for (auto it = std::find(open_.begin(), open_.end(), header); it != open_.end(); ++it)
      chain += *it + " -> ";
    return chain;
  }

  std::map<std::string, std::vector<Line>> lines_;
  Names open_, done_, found_;
};

Names violations(const std::vector<Source>& sources) {
  Names found = CycleSearch(sources).cycles();
  for (const auto& source : sources)
    check_file(source, found);
  return found;
}

std::vector<Source> read_sources() {
  namespace fs = std::filesystem;
  const fs::path root = fs::path(support::checkout()) / "src";
  std::vector<Source> sources;
  for (const auto& entry : fs::recursive_directory_iterator(root)) {
    const auto extension = entry.path().extension();
    if (extension != ".h" && extension != ".cc")
      continue;
    std::ostringstream text;
    text << std::ifstream(entry.path()).rdbuf();
    sources.push_back({fs::relative(entry.path(), root).generic_string(), text.str()});
  }
  return sources;
}

std::string joined(const Names& names) {
  std::string text;
  for (const auto& name : names)
    text += name + "\n";
  return text;
}

/// The one violation of these sources.
void expect_violation(const std::vector<Source>& sources, const std::string& place, const std::string& part) {
  const auto found = violations(sources);
  ASSERT_EQ(found.size(), 1u) << joined(found);
  EXPECT_TRUE(found[0].starts_with("src/" + place + ": ")) << found[0];
  EXPECT_NE(found[0].find(part), std::string::npos) << found[0];
}

TEST(Layers, RoomsUseOnlyRoomsBeforeThem) {
  Names before;
  for (const auto& room : rooms) {
    for (const auto& used : room.uses)
      EXPECT_TRUE(contains(before, used)) << room.name << " uses " << used;
    EXPECT_FALSE(contains(before, room.name)) << room.name << " has two rows";
    before.push_back(room.name);
  }
}

TEST(Layers, TheSourcesKeepTheRules) {
  const auto sources = read_sources();
  ASSERT_GT(sources.size(), 10u) << "no sources below " << support::checkout() << "/src";
  const auto found = violations(sources);
  EXPECT_TRUE(found.empty()) << joined(found);
}

TEST(LayersChecker, AcceptsWhatIsAllowed) {
  const auto found =
    violations({{"base/vec.h", "#include <array>\n#include <Eigen/Core>\n"},
                {"cut/blade.h", "#include \"base/vec.h\"\n#include \"grid/grid.h\"\n"},
                {"cut/blade.cc", "#include \"cut/blade.h\"\nint exit_code(); // never exit(1)\nint x = door.exit();\n"},
                {"geometry/solid.cc", "#include <CGAL/Surface_mesh.h>\n"},
                {"gl/api.h", "#include <GL/osmesa.h>\n"}});
  EXPECT_TRUE(found.empty()) << joined(found);
}

TEST(LayersChecker, SeesAStepBackUp) {
  expect_violation({{"grid/grid.h", "#pragma once\n\n#include \"cut/blade.h\"\n"}}, "grid/grid.h:3",
                   "grid may not include cut");
}

TEST(LayersChecker, SeesAnEdgeThatIsNotInTheTable) {
  expect_violation({{"surface/table.cc", "  #  include \"geometry/solid.h\" // why not\n"}}, "surface/table.cc:1",
                   "surface may not include geometry");
}

TEST(LayersChecker, SeesUnknownRooms) {
  expect_violation({{"attic/box.h", "\n"}}, "attic/box.h:1", "not in the table");
  expect_violation({{"base/id.h", "#include \"vec.h\"\n"}}, "base/id.h:1", "is in no room");
}

TEST(LayersChecker, SeesHeavyHeadersInTheWrongRoom) {
  expect_violation({{"grid/grid.cc", "\n#include <deal.II/grid/tria.h>\n"}}, "grid/grid.cc:2", "deal.II");
  expect_violation({{"cut/blade.cc", "#include <CGAL/Object.h>\n"}}, "cut/blade.cc:1", "CGAL");
  expect_violation({{"scene/run.cc", "#include <hdf5.h>\n"}}, "scene/run.cc:1", "hdf5.h");
  expect_violation({{"scene/run.cc", "#include <H5Cpp.h>\n"}}, "scene/run.cc:1", "H5Cpp");
  expect_violation({{"render/image.cc", "#include <GL/gl.h>\n"}}, "render/image.cc:1", "GL/gl.h");
}

TEST(LayersChecker, SeesIncludeCycles) {
  const std::vector<Source> sources = {{"base/a.h", "#include \"base/b.h\"\n"},
                                       {"base/b.h", "\n#include \"base/c.h\"\n"},
                                       {"base/c.h", "#include \"base/b.h\"\n"}};
  expect_violation(sources, "base/c.h:1", "base/b.h -> base/c.h -> base/b.h");
  expect_violation({{"base/a.h", "#include \"base/a.h\"\n"}}, "base/a.h:1", "base/a.h -> base/a.h");
}

TEST(LayersChecker, SeesWhatEndsTheProcess) {
  for (const std::string call :
       {"std::abort();", "exit (1);", "  if (bad) std::exit(2);", "_Exit(1);", "std::terminate();"})
    expect_violation({{"fem/model.cc", "\n\n" + call + "\n"}}, "fem/model.cc:3", "end the process");
}

TEST(LayersChecker, SeesLongFiles) {
  const std::string longest(max_lines, '\n');
  EXPECT_TRUE(violations({{"fem/model.cc", longest}}).empty());
  expect_violation({{"fem/model.cc", longest + "\n"}}, "fem/model.cc:501", "at most 500 lines");
}

} // namespace
} // namespace kerf::layers_test
