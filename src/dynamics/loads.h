#pragma once

/// What acts on a body from outside.

#include "base/loan.h"
#include "base/vec.h"
#include "dynamics/load.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace kerf::dynamics {

/// Corners that go where they are told: x(t) = rotation(t) rest + displacement(t).
struct Support {
  std::vector<std::uint32_t> corners;
  Points rest;                                    ///< where these corners are when nothing has moved [m]
  std::function<Vec3(double time)> displacement;  ///< world frame [m]
  std::function<Mat3(double time)> rotation = {}; ///< about the origin; empty: never turned
  /// Projector onto the directions that are held, world frame [1]: the corners slide along the others. See held_along.
  Mat3 held = Mat3::Identity();

  /// Where its corners are at one time: a function of their `rest`.
  struct Places {
    Mat3 rotation;
    Vec3 displacement; ///< [m]
    Vec3 operator()(const Vec3& rest) const { return rotation * rest + displacement; }
  };
  Places places(double time) const; ///< time in s
};

/// Support::held for one direction of any length; throws ParameterError when it is zero.
Mat3 held_along(const Vec3& direction);
/// Support::held for a word out of hold_words(): "all", or the axes that are held.
Mat3 held_axes(const std::string& word);
const std::vector<std::string>& hold_words();

struct Loads {
  Vec3 gravity = Vec3::Zero();  ///< acceleration [m/s^2]
  double mass_damping = 0;      ///< Rayleigh's alpha: a force -alpha M v [1/s]
  double stiffness_damping = 0; ///< Rayleigh's beta: a force -beta K v [s]
  std::vector<Support> supports;
  std::vector<std::unique_ptr<Load>> acting = {}; ///< beside gravity
  /// 1 for each corner that a rigid body carries: it has no mass and no freedom of its own, stays where it is in a
  /// step, and is moved by whoever moves the body. Supports do not see it. Empty: none.
  std::vector<std::uint8_t> carried = {};
};

inline bool is_carried(const Loads& loads, const std::size_t corner) {
  return corner < loads.carried.size() && loads.carried[corner] != 0;
}

/// Those with a potential alone, which must outlive it: no gravity, damping or supports.
Loads potentials_of(const Loads& loads);

/// 1 for each corner that supports hold in all directions, or that a body carries.
Loan<std::uint8_t> held_corners(const Loads& loads, std::size_t n_corners);

/// Puts held corners where they belong at `time`; their velocities are the mean ones over the step dt that led there.
void move_held(const Loads& loads, double time, double dt, Points& x, Points& v);

/// Two supports that want one corner in different places.
struct Contradiction {
  std::size_t first, second; ///< in Loads::supports
  std::uint32_t corner;
  double distance; ///< by which they differ along directions that both hold [m]
};

/// The first contradiction of more than `tolerance` [m] at a time [s], if any.
std::optional<Contradiction> find_contradiction(const Loads& loads, double time, double tolerance);

} // namespace kerf::dynamics
