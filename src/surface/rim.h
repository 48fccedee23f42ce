#pragma once

/// Where a cut meets the skin, its rim. In a face the skin is a bent line from one edge of the skin over the skin's
/// vertex to the other; in a cell it is the fan of triangles around the skin's centre. The rim is where the plane of
/// the cut meets them; it has one vertex in each face and one in the cell. So the skin itself never moves.

#include "surface/planes.h"

#include <array>
#include <span>

namespace kerf::surface {

struct RimPoint {
  Vec3 p;             ///< [m]
  int side_of_corner; ///< 0 or 1: the end of the line that is on the corner's side
  bool is_met = true; ///< false where the plane passes beside the line: p is as near as the line comes
};

/// The plane on the line first - corner - second.
RimPoint meet_line(const Plane& plane, const Vec3& first, const Vec3& corner, const Vec3& second);

/// The vertex in a cell of a rim from one point to another: where it bends most as it crosses the spokes from the fan's
/// centre; halfway where it is straight.
Vec3 rim_in_fan(const Plane& plane, const Vec3& start, const Vec3& end, const Vec3& centre,
                std::span<const Vec3> spoke_ends);

/// How much of the way from one point to another, in [0, 1], lies before the line first - corner - second, all in a
/// plane with this normal's axis.
double part_before_line(const Vec3& from, const Vec3& to, const Vec3& first, const Vec3& corner, const Vec3& second,
                        int normal);

/// The same before a triangle.
double part_before(const Vec3& from, const Vec3& to, const std::array<Vec3, 3>& triangle);

} // namespace kerf::surface
