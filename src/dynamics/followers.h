#pragma once

/// How corners without mass go along with those that lead them.
///
/// A follower has no motion of its own: the balance of forces gives its place, and no equation its velocity. Led
/// affinely it would have what its leaders have of vibrations that no step resolves, magnified by its distance to them
/// over a cube: one ran at 3.8 m/s where 99 of 100 corners were below 1.5 m/s. Led by the rigid motion that is nearest
/// to theirs by mass, it would turn with leaders that are nearly in a row, and rattle. So beside the mean motion of its
/// leaders it takes the slower of the two. Where a body turns both are the same, unless its leaders lie in a plane: the
/// affine one then says nothing across it.

#include "dynamics/model.h"

namespace kerf::dynamics {

/// What leaders give a follower of what they have: velocities [m/s], or small displacements [m], at places x [m].
/// In a row they give their mean. `mass` of each corner [kg].
Vec3 led_along(const Follower& follower, std::span<const double> mass, const Points& x, const Points& values);

/// Velocities of all followers at places x.
void lead_along(const ForceModel& model, const Points& x, Points& v);

} // namespace kerf::dynamics
