#pragma once

/// What a crumb (grid/crumbs.h) is at rest, and how it moves when it becomes one.

#include "dynamics/rigid_body.h"
#include "grid/solid.h"

namespace kerf::physics {

/// Of some points: positions [m] and velocities [m/s].
struct Motion {
  Points x, v;
};

struct CrumbBody {
  dynamics::RigidBody body;
  std::vector<std::uint32_t> corners;  ///< ascending
  std::vector<double> mass_of_corners; ///< integrals of their shape functions, times density [kg]
  Points rest_of_corners;              ///< [m]

  void archive(Archive& a) { a(body, corners, mass_of_corners, rest_of_corners); }
};

/// By the material of its copies: mass, centre and inertia are exact. But a piece of hardly any volume counts as 1e-12
/// of a cube, and none is thinner than a hundredth of a cube: spins stay finite.
CrumbBody measure(const grid::Solid& solid, const grid::Crumb& crumb, double density);

/// The rigid motion nearest to that of its material, whose corners move as `now` has it: with their momentum, mean
/// rotation and angular velocity.
dynamics::RigidMotion motion_of(const CrumbBody& crumb, const Motion& now);

} // namespace kerf::physics
