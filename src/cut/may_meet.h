#pragma once

/// Whether a shape can meet anything in a box: never no when it does, so that whoever asks may leave the box out.
/// Round-off counts as meeting.

#include "base/vec.h"

#include <limits>
#include <span>

namespace kerf::cut {

/// Where points, and all between them, are along an axis, in units of its length.
struct Interval {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  double size = 0; ///< of the largest coordinates that went in

  Interval() = default;
  Interval(std::span<const Vec3> points, const Vec3& axis);
  Interval(const Box& box, const Vec3& axis);
};
bool are_apart(const Interval& a, const Interval& b, const Vec3& axis);

/// The plane through `point` with a normal of any length.
bool may_meet(const Vec3& point, const Vec3& normal, const Box& box);

/// Two sets of points that an axis of any length parts, and all between them.
bool are_apart(std::span<const Vec3> a, std::span<const Vec3> b, const Vec3& axis);

std::array<Vec3, 8> corners_of(const Box& box);

} // namespace kerf::cut
