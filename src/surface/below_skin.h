#pragma once

/// How far one may go below the skin before coming to it.

#include "base/vec.h"

#include <array>

namespace kerf::surface {

/// How much of the way from one point to another, in [0, 1], lies before the line first - corner - second, all in a
/// plane with this normal's axis.
double part_before_line(const Vec3& from, const Vec3& to, const Vec3& first, const Vec3& corner, const Vec3& second,
                        int normal);

/// The same before a triangle.
double part_before(const Vec3& from, const Vec3& to, const std::array<Vec3, 3>& triangle);

} // namespace kerf::surface
