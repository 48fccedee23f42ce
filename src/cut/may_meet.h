#pragma once

/// Whether a shape can meet anything in a box: never no when it does, so that whoever asks may leave the box out. Round-off
/// counts as meeting.

#include "base/vec.h"

#include <span>

namespace kerf::cut {

/// The plane through `point` with a normal of any length.
bool may_meet(const Vec3& point, const Vec3& normal, const Box& box);

/// Two sets of points that an axis of any length parts, and all between them.
bool are_apart(std::span<const Vec3> a, std::span<const Vec3> b, const Vec3& axis);
/// The same of a box.
bool are_apart(std::span<const Vec3> points, const Box& box, const Vec3& axis);

std::array<Vec3, 8> corners_of(const Box& box);

} // namespace kerf::cut
