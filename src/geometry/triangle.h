#pragma once

/// A single triangle in rounded arithmetic, for places rather than decisions.

#include "base/vec.h"

#include <optional>

namespace kerf::geometry {

/// The point of the triangle nearest to p [m].
Vec3 closest_point(const Vec3& p, const std::array<Vec3, 3>& triangle);

/// The point nearest to p [m] of where the triangle meets the plane through p with the given axis as normal; nothing
/// when it does not.
std::optional<Vec3> closest_point_in_plane(const Vec3& p, int axis, const std::array<Vec3, 3>& triangle);

/// s where the line p + s d meets the triangle; nothing when it does not, or runs along it.
std::optional<double> line_meets(const Vec3& p, const Vec3& d, const std::array<Vec3, 3>& triangle);

} // namespace kerf::geometry
