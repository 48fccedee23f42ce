#pragma once

/// What a path of paths.h is, and the bodies on which it is measured.

#include "bench/paths.h"
#include "scene/world.h"

#include <limits>
#include <memory>

namespace kerf::bench {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// What one call of a path takes, as far as it can be counted.
struct Need {
  double flops = unknown, bytes = unknown;
};
constexpr Need operator+(const Need& a, const Need& b) { return {a.flops + b.flops, a.bytes + b.bytes}; }
constexpr Need operator*(const double n, const Need& one) { return {n * one.flops, n * one.bytes}; }

/// A path at one size, ready to be called again and again.
struct Ready {
  std::size_t n_items;
  std::function<void()> call;
  Need need = {};
};
/// Or measured by itself, as a cut that can be made once.
struct Measured {
  std::size_t n_items;
  Sample sample;
  Need need = {};
};

/// A kind of body, and the paths that are measured on it.
struct Path {
  std::string name, item;
  std::function<Ready(scene::World& world)> on; ///< one of these two
  std::function<Measured(int n, const Options& options)> by_itself;
};
struct Group {
  std::function<std::string(int n)> scene;
  double largest; ///< cells from which on it takes too long
  std::vector<Path> paths;
};

/// A cube of 1 m around the origin with n nodes across in n + 1 cells, the outer ones half full, that hangs from its
/// upper side; and what else there is in the body and in the scene.
std::string cube_scene(int n, double dt, int n_steps, const std::string& body, const std::string& beside = "");
/// Paths start, and caches lie, at the folder of `file`.
std::unique_ptr<scene::World> world_of(const std::string& text, const std::string& file = "a benchmark's scene");

/// Positions off rest by a hundredth of a cube.
Points stirred(const Points& rest, double h, double phase = 1);

/// Paths beside the steps: statics and modes, the surface, the inside, files and images (beside_steps.cc).
std::vector<Group> groups_beside_steps();

} // namespace kerf::bench
