#pragma once

/// Where a point lies against a triangle, and whether a segment crosses it: exact, with one rule for every contact.
///
/// The rule: the cutting surface is displaced by the infinitesimal vector d = (eps, eps^2, eps^3), eps -> 0+. All
/// triangles get the same d, so triangles that share an edge still share it, and no point lies on one, no segment meets
/// an edge of one: a surface has no hole for a segment to slip through and no seam where it would count twice.
///
/// Method: orientations are linear in d (d x d = 0), orient(a+d, b+d, c+d, p) = n . (p - a) - n . d with n = (b-a) x
/// (c-a), and orient(p, q, a+d, b+d) = orient(p, q, a, b) + d . ((q-p) x (a-b)). The first term decides by its exact
/// sign; where it is 0, the first component of the factor of d that is not 0 does, since eps >> eps^2 >> eps^3. Signs
/// come from CGAL's filtered kernel.
///
/// Limit: coordinates must be far from overflow and underflow (1e-60 to 1e60 will do).

#include "base/vec.h"

namespace kerf::geometry {

/// Which side of the displaced triangle p is on: +1 where its normal (b-a) x (c-a) points, -1 opposite; 0 only for a
/// triangle without area, which has no sides.
int side(const Vec3& p, const std::array<Vec3, 3>& triangle);

/// Does the segment pq cross the displaced triangle? Symmetric in p and q and in the order of the triangle's corners.
/// A triangle without area crosses nothing.
bool crosses(const Vec3& p, const Vec3& q, const std::array<Vec3, 3>& triangle);

/// Where the line through `p` along `axis` (0, 1, 2 = x, y, z) crosses the displaced triangle: the side() of points far
/// up the line (+1 or -1), or 0 when it does not cross. Agrees with crosses() for every segment of the line.
int line_crosses(const Vec3& p, int axis, const std::array<Vec3, 3>& triangle);

/// Position of a crossing along pq, in [0, 1] [1], rounded.
double crossing_parameter(const Vec3& p, const Vec3& q, const std::array<Vec3, 3>& triangle);

/// Unit normal (b-a) x (c-a) of a triangle; zero for one without area.
Vec3 unit_normal(const std::array<Vec3, 3>& triangle);

} // namespace kerf::geometry
