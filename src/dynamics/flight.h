#pragma once

/// Many rigid bodies at once, eight side by side: what rigid_body.h does of each, to round-off. What becomes of a body
/// does not depend on those beside it.

#include "base/function_ref.h"
#include "dynamics/rigid_body.h"

#include <cstdint>
#include <span>

namespace kerf::dynamics {

using BodyOf = FunctionRef<const RigidBody&(std::size_t)>;

/// All fly for dt [s] under gravity [m/s^2] and mass damping alpha [1/s].
void fly(BodyOf body, const Vec3& gravity, double alpha, double dt, std::span<RigidMotion> motions);

/// Of all, world frame [rad/s].
void put_angular_velocities(BodyOf body, std::span<const RigidMotion> motions, std::span<Vec3> omegas);

/// Puts points of a body, which rest at `rest` [m], where it is: that of number i to x[places[i]] [m] and v[places[i]]
/// [m/s].
void carry(const RigidBody& body, const RigidMotion& motion, const Vec3& omega, std::span<const Vec3> rest,
           const std::uint32_t* places, Points& x, Points& v);

} // namespace kerf::dynamics
