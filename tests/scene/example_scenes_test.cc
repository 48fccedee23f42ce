// Every scene in params/ composes, runs some steps and writes what it asks for.

#include "cut/recut.h"
#include "tests/scene/worlds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

namespace kerf::scene::example_scenes_test {
namespace {

namespace fs = std::filesystem;

/// Studies are no scenes, those are tested by their own room; nor is what has no section Time.
std::vector<fs::path> example_scenes() {
  std::vector<fs::path> files = parameter_files();
  std::erase_if(files, [](const fs::path& file) {
    return file.parent_path().filename() == "studies" || !read_scene_text(file.string(), {}).root.find_section("Time");
  });
  return files;
}

/// Cheap to draw, where the scene draws.
Overrides small_images(const fs::path& file) {
  SceneText text = read_scene_text(file.string(), {});
  if (!text.root.find_section("Images"))
    return {};
  return {"Images/Width [1]=96", "Images/Height [1]=64", "Images/Every [1]=2"};
}

std::size_t n_images(const fs::path& folder) {
  std::size_t n = 0;
  for (const auto& entry : fs::directory_iterator(folder / "frames")) {
    std::ifstream in(entry.path(), std::ios::binary);
    std::string start(8, ' ');
    in.read(start.data(), 8);
    n += start == "\x89PNG\r\n\x1a\n" ? 1 : 0;
  }
  return n;
}

void expect_outputs(const World& world, const fs::path& folder) {
  const output::Reader reader(folder / "run.h5");
  EXPECT_EQ(reader.outcome(), output::Outcome::completed);
  EXPECT_EQ(reader.n_steps(), world.n_steps + 1u);
  EXPECT_EQ(reader.composition(), world.composition);
  ASSERT_EQ(reader.bodies().size(), world.bodies.size());
  for (const Body& body : world.bodies) {
    const std::size_t n = reader.n_frames(body.name);
    ASSERT_GE(n, 2u);
    const output::Frame last = reader.frame(body.name, n - 1);
    EXPECT_EQ(last.step, world.n_steps);
    EXPECT_EQ(last.positions, body.state.x);
    EXPECT_EQ(last.velocities, body.state.v);
    EXPECT_EQ(reader.complex(body.name, last.complex).corners.size(), body.solid.complex.n_copies());
    for (const Observable& o : body.observables)
      EXPECT_EQ(reader.observable(body.name + " " + o.name).size(), world.n_steps + 1u) << o.name;
    EXPECT_EQ(fs::exists(folder / ("surface_" + body.name + ".vtkhdf")), world.surface_file.has_value());
  }
  EXPECT_EQ(fs::exists(folder / "frames"), world.images.has_value());
  if (world.images) {
    EXPECT_EQ(n_images(folder), 3u); // of steps 0, 2 and the last
  }
}

/// Whether a blade meets an edge on its way, step by step, of bodies that stay at rest.
bool meets_a_body(const cut::Blade& blade, const World& world) {
  for (int step = 1; step <= world.n_steps; ++step) {
    const auto strip = cut::sweep(blade, (step - 1) * world.time_step, step * world.time_step);
    for (const Body& body : world.bodies)
      if (!cut::cut_edges(strip, body.solid, body.state.x, blade.label).cuts.empty())
        return true;
  }
  return false;
}

/// Every blade that moves meets a body, too.
TEST(ExampleScenes, ComposeAndRunSomeSteps) {
  const auto files = example_scenes();
  EXPECT_GE(files.size(), 3u);
  for (const fs::path& file : files) {
    SCOPED_TRACE(file.string());
    const output::TemporaryFolder folder;
    World world = compose(read_scene_text(file.string(), small_images(file)));
    for (const cut::Blade& blade : world.blades)
      if (!cut::sweep(blade, 0, world.n_steps * world.time_step).empty()) {
        EXPECT_TRUE(meets_a_body(blade, world)) << blade.name;
      }
    world.n_steps = 3;
    run_silently(world, folder / "out");
    expect_outputs(world, folder / "out");
  }
}

/// To its end.
TEST(ExampleScenes, ALobeOfTheLiverComesFree) {
  const output::TemporaryFolder folder;
  World world = compose(read_scene_text(support::checkout() + "/params/liver.prm", {}));
  world.images.reset();
  world.surface_file.reset();
  run_silently(world, folder / "out");
  const auto pieces = output::Reader(folder / "out/run.h5").observable("liver pieces");
  EXPECT_EQ(pieces.front(), 1);
  EXPECT_EQ(pieces.back(), 2);
}

} // namespace
} // namespace kerf::scene::example_scenes_test
