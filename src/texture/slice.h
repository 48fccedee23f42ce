#pragma once

/// Where a plane cuts a closed mesh.

#include "geometry/triangle_mesh.h"
#include "image/image.h"
#include "texture/plane.h"

#include <Eigen/Geometry>

#include <array>
#include <cmath>

namespace kerf::texture {

/// A frame in space: a point p is at ((p - origin) . x, (p - origin) . y).
struct Frame {
  Vec3 origin, x, y;
  Vec3 normal() const { return x.cross(y); }
};
inline Frame frame_of(const SectionPlane& plane) { return {plane.origin(), plane.x(), plane.y()}; }

/// Both ends in the frame's coordinates [m].
using Segment = std::array<Vec2, 2>;

/// The closed curves in which a plane cuts a closed mesh, in pieces without order. A vertex in the plane counts as
/// above it, so that curves always close.
std::vector<Segment> slice(const geometry::TriangleMesh& mesh, const Frame& frame);

/// An allowed half of space: normal . p <= offset.
struct HalfSpace {
  Vec3 normal = Vec3::Zero();
  double offset = 0;
  bool contains(const Vec3& p) const { return normal.dot(p) <= offset; }
};

/// Directions all around a point, by number: those of equal steps along the square |x| + |y| = 1, which takes no
/// trigonometry to find.
Vec2 direction(int number, int n_directions);
/// The place of a direction among them, in [0, n).
inline double direction_number(const double x, const double y, const int n_directions) {
  const double sum = std::abs(x) + std::abs(y);
  if (!(sum > 0))
    return 0;
  const double part = y / sum; // sin-like
  const double quarter = x >= 0 ? (y >= 0 ? part : 4 + part) : 2 - part;
  const double number = quarter * (0.25 * n_directions);
  return number >= n_directions ? 0 : number;
}

/// How far it is from `centre` to the border of what lies inside the slice and the half spaces, in each direction [m];
/// 0 where there is nothing. Of several borders the one next to `guess` [m] counts, the outermost without guesses.
std::vector<double> radii(const std::vector<Segment>& slice, const Frame& frame, const std::vector<HalfSpace>& halves,
                          const Vec2& centre, int n_directions, const std::vector<double>& guess = {});

/// The middle of the star with these radii around a centre.
Vec2 star_middle(const Vec2& centre, const std::vector<double>& radii);

/// 1 where the middle of a pixel lies inside curves that are given in pixels.
image::Grey inside_of(const std::vector<Segment>& curves_in_pixels, int width, int height);

} // namespace kerf::texture
