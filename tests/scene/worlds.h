#pragma once

/// Worlds composed from texts, and runs of them without a word.

#include "output/reader.h"
#include "scene/compose.h"
#include "scene/run.h"
#include "tests/output/samples.h"
#include "tests/scene/scene_text.h"
#include "tests/support/checkout.h"

#include <algorithm>
#include <random>

namespace kerf::scene {

inline World world_of(const std::string& text, const Overrides& overrides = {}) {
  return compose(scan_scene_text(text, "scene.prm", overrides));
}

/// Runs a world into a folder; returns the seconds of its stages.
inline Timings run_silently(World& world, const std::filesystem::path& folder) {
  Recorder recorder(folder, world, {output::sample_info(), "the scene", {}}, output::Earlier::replace);
  Progress progress(world.n_steps, world.n_steps * world.time_step, ProgressStyle::silent, stdout);
  return run(world, recorder, progress);
}

/// n vectors, normally distributed.
inline Points random_points(const std::size_t n, const double deviation, const unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, deviation);
  Points points(n);
  for (Vec3& p : points)
    for (int axis = 0; axis < 3; ++axis)
      p[axis] = normal(random);
  return points;
}

/// Gives all corners one velocity and a random one each.
inline void set_in_motion(Body& body, const Vec3& common, const double deviation) {
  body.state.v = random_points(body.state.v.size(), deviation, 5);
  for (Vec3& v : body.state.v)
    v += common;
}

/// The parameter files anywhere below a folder of params/, sorted.
inline std::vector<std::filesystem::path> parameter_files(const std::string& folder = "") {
  std::vector<std::filesystem::path> files;
  const auto root = std::filesystem::path(support::checkout()) / "params" / folder;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(root))
    if (entry.path().extension() == ".prm")
      files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

/// What an observable says now.
inline double value(const Body& body, const std::string& observable) {
  return find_observable(observable)->value(body);
}

} // namespace kerf::scene
