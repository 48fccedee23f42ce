#pragma once

/// What is drawn of a sweep in a front's plane.

#include "cut/cell_at_plane.h"
#include "cut/raster.h"

namespace kerf::cut {

constexpr double off_plane = 0.25; ///< what lies farther off a front's plane is not drawn [cubes]
constexpr double texel = Raster::side / Raster::n; ///< [cubes]

/// Coordinates in a plane and above it, in cubes.
struct InPlane {
  InPlane(const Vec3& point, const Vec3& normal, double h);
  Vec3 operator()(const Vec3& p) const { return {u.dot(p - origin), v.dot(p - origin), w.dot(p - origin)}; }
  Vec3 point(const Eigen::Vector2d& p) const { return origin + (p[0] * u + p[1] * v) / w.squaredNorm(); }

  Vec3 origin, u, v, w;
};

/// The convex hull of points, in the plane.
Polygon hull(const Points& points, const InPlane& in_plane);

/// Returns how many texels are drawn that were not.
int draw(const Polygon& piece, const InPlane& in_plane, Raster& raster);

} // namespace kerf::cut
