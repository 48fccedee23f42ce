#pragma once

/// What acts on a body from outside.

#include "base/vec.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace kerf::dynamics {

/// Corners that go where they are told.
struct Support {
  std::vector<std::uint32_t> corners;
  Points rest;                                   ///< rest positions of these corners [m]
  std::function<Vec3(double time)> displacement; ///< from rest, world frame [m]
};

struct Loads {
  Vec3 gravity = Vec3::Zero();  ///< acceleration [m/s^2]
  double mass_damping = 0;      ///< Rayleigh's alpha: a force -alpha M v [1/s]
  double stiffness_damping = 0; ///< Rayleigh's beta: a force -beta K v [s]
  std::vector<Support> supports;
};

/// 1 for each corner that a support holds.
std::vector<std::uint8_t> held_corners(const Loads& loads, std::size_t n_corners);

/// Puts held corners where they belong at `time`; their velocities are the mean ones over the step dt that led there.
void move_held(const Loads& loads, double time, double dt, Points& x, Points& v);

} // namespace kerf::dynamics
