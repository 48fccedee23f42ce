// Colours of revealed triangles in a run's file, while their places in the atlas are used again.

#include "base/parallel.h"
#include "output/h5_array.h"
#include "tests/scene/striped_cube.h"

#include <algorithm>

namespace kerf::scene::recorded_samples_test {
namespace {

using Rows = std::vector<std::uint8_t>; // three a sample

class RecordedSamples : public StripedCube {
 protected:
  output::h5::Object run_file(const std::string& name) const {
    return output::h5::open_read_only(folder / name / "run.h5");
  }
  static Rows rows(const output::h5::Object& file) {
    return output::h5::read_vector<std::uint8_t>(file, "/bodies/cube/colours");
  }
  static std::vector<std::uint32_t> first_rows(const output::h5::Object& file, const std::string& surface) {
    return output::h5::read_vector<std::uint32_t>(file, "/bodies/cube/surface/" + surface + "/first_sample");
  }
  static std::vector<std::string> surfaces(const output::h5::Object& file) {
    return output::h5::children(file, "/bodies/cube/surface");
  }
  /// Of what the scene is, no matter when it is run.
  static Source source() { return {output::sample_info(), "the scene", {}}; }

  static constexpr double resolution = 0.002; // [m]
  /// Each step has a frame.
  World world() const {
    World world = composed(at_resolution(striped_across(scene()), "0.002"));
    world.output.frames_every = 1;
    return world;
  }
};

Rows rows_of(const texture::Atlas& atlas, const std::size_t t) {
  Rows rows;
  const std::size_t first = atlas.first()[t], n = texture::n_samples(atlas.parts()[t]);
  for (std::size_t sample = first; sample < first + n; ++sample)
    rows.insert(rows.end(), atlas.colours()[sample].begin(), atlas.colours()[sample].end());
  return rows;
}

/// Every surface of a file shows what its triangles show when they are painted at once, the ones of long ago too.
TEST_F(RecordedSamples, EverySurfaceShowsWhatItDidThen) {
  World world = this->world();
  run_silently(world, folder / "out");
  const BodyInterior& interior = *world.bodies.front().interior;
  const auto file = run_file("out");
  const Rows all = rows(file);
  EXPECT_GT(all.size(), 3 * interior.atlas.colours().size()); // places that were used again have one row each time
  const output::Reader reader(folder / "out" / "run.h5");
  const std::size_t n_surfaces = reader.n_surfaces("cube");
  EXPECT_GE(n_surfaces, 4u);
  ASSERT_EQ(surfaces(file).size(), n_surfaces);
  std::size_t n_revealed = 0;
  for (std::size_t i = 0; i < n_surfaces; ++i) {
    const output::Surface surface = reader.surface("cube", i);
    const auto first = first_rows(file, surfaces(file)[i]);
    const texture::Atlas anew =
      painted_anew(interior, {surface.rest_positions, surface.triangles, surface.labels}, resolution);
    ASSERT_EQ(first.size(), surface.triangles.size());
    for (std::size_t t = 0; t < first.size(); ++t) {
      ASSERT_EQ(first[t] == texture::Atlas::none, anew.first()[t] == texture::Atlas::none);
      if (first[t] == texture::Atlas::none)
        continue;
      const Rows wanted = rows_of(anew, t);
      ASSERT_LE(3 * first[t] + wanted.size(), all.size());
      EXPECT_TRUE(std::equal(wanted.begin(), wanted.end(), all.begin() + 3 * static_cast<std::ptrdiff_t>(first[t])))
        << "triangle " << t << " of surface " << i;
      ++n_revealed;
    }
  }
  EXPECT_GT(n_revealed, 1000u);
}

/// What the blade has moved on since, between two frames, is not in the file.
TEST_F(RecordedSamples, OfFewFramesAreFew) {
  const auto n_rows = [&](const int every) {
    World world = this->world();
    world.output.frames_every = every;
    run_silently(world, folder / "out");
    return rows(run_file("out")).size() / 3;
  };
  const std::size_t of_all = n_rows(1), of_last = n_rows(1000);
  World world = this->world();
  run_silently(world, folder / "out");
  std::size_t n_now = 0;
  for (const int parts : world.bodies.front().interior->atlas.parts())
    n_now += parts > 0 ? texture::n_samples(parts) : 0;
  EXPECT_EQ(of_last, n_now);
  EXPECT_GT(of_all, n_now);
}

TEST_F(RecordedSamples, AreTheSameOfARunThatIsResumed) {
  World whole = world();
  run_silently(whole, folder / "whole");
  for (const int step_kept : {1, 2, 3}) {
    const std::string out = "out_" + std::to_string(step_kept);
    {
      World ended = world();
      Recorder recorder(folder / out, ended, source(), output::Earlier::replace);
      Timings seconds;
      recorder.record(ended, 0, seconds);
      for (int step = 1; step <= 4; ++step) { // the file holds steps after the checkpoint
        advance(ended, step, seconds);
        recorder.record(ended, step, seconds);
        if (step == step_kept)
          recorder.keep_now(ended, step);
      }
    }
    World resumed = world();
    Recorder recorder(folder / out, resumed, source(), output::Earlier::resume);
    Progress progress(resumed.n_steps, resumed.n_steps * resumed.time_step, ProgressStyle::silent, stdout);
    run(resumed, recorder, progress);
    const texture::Atlas &wanted = whole.bodies.front().interior->atlas,
                         &atlas = resumed.bodies.front().interior->atlas;
    EXPECT_EQ(atlas.first(), wanted.first());
    EXPECT_EQ(atlas.colours(), wanted.colours());
    const auto a = run_file("whole"), b = run_file(out);
    EXPECT_EQ(rows(a), rows(b));
    ASSERT_EQ(surfaces(a), surfaces(b));
    for (const std::string& surface : surfaces(a))
      EXPECT_EQ(first_rows(a, surface), first_rows(b, surface)) << surface;
  }
}

TEST_F(RecordedSamples, AreTheSameForOneThreadAndTwo) {
  const int n = n_threads();
  std::vector<texture::Atlas> atlases;
  std::vector<Rows> recorded;
  for (const int threads : {1, 2}) {
    set_n_threads(threads);
    World world = this->world();
    run_silently(world, folder / "out");
    atlases.push_back(world.bodies.front().interior->atlas);
    recorded.push_back(rows(run_file("out")));
  }
  set_n_threads(n);
  EXPECT_EQ(atlases[0].first(), atlases[1].first());
  EXPECT_EQ(atlases[0].colours(), atlases[1].colours());
  EXPECT_EQ(recorded[0], recorded[1]);
}

} // namespace
} // namespace kerf::scene::recorded_samples_test
