#pragma once

/// What is drawn of a sweep in a front's plane.

#include "cut/cell_at_plane.h"
#include "cut/raster.h"
#include "grid/cuts.h"

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

/// Sets the line in which a cut ends in its cell (grid::Front): it divides the texels of the section into as many as
/// the cut has come to and the others, across the way from the middle of these on to that of all. Where the cut has
/// come to all or none of them, or that way is shorter than a texel, it is that of the earlier line; else the one from
/// what is cut with its lag, or from what is cut around. Where none is known the front stays as it is.
void put_end(const Raster& section, const Raster& come, const Raster& with_lag, double h, grid::Front& front);

/// Where what moves a front now has come less far than it had come before, or hardly farther, it ends where it did:
/// what is seen of a cut is made anew each time that its end moves. True: it stays.
bool keep_farther_end(const grid::Front& earlier, double h, grid::Front& moved);

} // namespace kerf::cut
