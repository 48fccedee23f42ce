#pragma once

/// How corners without mass go along with those that lead them.
///
/// A follower has no motion of its own: the balance of forces gives its place, and no equation its velocity. Led affinely
/// it would have what its leaders have of vibrations that no step resolves, magnified by its distance to them over a
/// cube: one ran at 3.8 m/s where 99 of 100 corners were below 1.5 m/s. So its velocity is that of a rigid motion, the
/// nearest to theirs by mass; where a body turns, that is the affine one too.

#include "dynamics/model.h"

namespace kerf::dynamics {

/// What the leaders' rigid motion gives a follower of what they have: velocities [m/s], or small displacements [m], at
/// places x [m]. Of leaders in a row, their mean motion. `mass` of each corner [kg].
Vec3 led_rigidly(const Follower& follower, std::span<const double> mass, const Points& x, const Points& values);

/// Velocities of all followers at places x.
void lead_rigidly(const ForceModel& model, const Points& x, Points& v);

} // namespace kerf::dynamics
