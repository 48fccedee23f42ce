// The scenes of params/compare run with every backend, changed by one line.

#include "tests/scene/worlds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace kerf::scene::compare_scenes_test {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> compare_scenes() { return parameter_files("compare"); }

SceneText with_backend(const fs::path& file, const std::string& backend) {
  SceneText text = read_scene_text(file.string(), {});
  const auto is_body = [](const WrittenSection& section) { return section.heading.starts_with("Body "); };
  const std::string heading = std::find_if(text.root.sections.begin(), text.root.sections.end(), is_body)->heading;
  text = read_scene_text(file.string(), {heading + "/Backend=" + backend});
  std::erase_if(text.root.sections, [](const WrittenSection& section) { return section.heading == "Images"; });
  return text;
}

double speed(const Body& body) {
  double sum = 0;
  for (const Vec3& v : body.state.v)
    sum += v.norm();
  return sum / double(body.state.v.size());
}

class CompareScenes : public testing::TestWithParam<std::string> {};

TEST_P(CompareScenes, RunSomeSteps) {
  const auto files = compare_scenes();
  ASSERT_EQ(files.size(), 7u);
  for (const fs::path& file : files) {
    SCOPED_TRACE(file.string());
    const output::TemporaryFolder folder;
    World world = compose(with_backend(file, GetParam()));
    const std::size_t n_before = world.bodies.at(0).solid.complex.n_copies();
    world.n_steps = 5;
    run_silently(world, folder / "out");
    const Body& body = world.bodies.at(0);
    EXPECT_EQ(output::Reader(folder / "out" / "run.h5").n_steps(), 6u);
    EXPECT_TRUE(std::isfinite(value(body, "volume")));
    EXPECT_GT(speed(body), 0);
    EXPECT_EQ(body.solid.complex.n_copies() > n_before, !world.cut_surfaces.empty());
  }
}

INSTANTIATE_TEST_SUITE_P(Backends, CompareScenes, testing::Values("fem", "pba", "lattice", "mass-spring"),
                         [](const auto& backend) {
                           return backend.param == "mass-spring" ? std::string("springs") : backend.param;
                         });

/// One line to change.
TEST(CompareScenes, NameTheirBackendOnce) {
  for (const fs::path& file : compare_scenes()) {
    SCOPED_TRACE(file.string());
    const std::string text = read_scene_text(file.string(), {}).text;
    const std::size_t at = text.find("  set Backend ");
    ASSERT_NE(at, std::string::npos);
    EXPECT_EQ(text.find("  set Backend ", at + 1), std::string::npos);
  }
}

} // namespace
} // namespace kerf::scene::compare_scenes_test
