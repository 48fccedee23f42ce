#pragma once

/// The volume of a box on one side of a plane, to round-off.

#include "tests/support/bodies.h"

#include <Eigen/Geometry>

namespace kerf::support {

/// The part of a convex polygon where the plane's height is negative.
inline Points clip(const Points& polygon, const Plane& plane) {
  Points kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3 &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const double a = plane.height(p), b = plane.height(q);
    if (a < 0)
      kept.push_back(p);
    if ((a < 0) != (b < 0))
      kept.push_back(p + a / (a - b) * (q - p));
  }
  return kept;
}

/// Pyramids from a point of the plane over the clipped sides of the box; the section itself adds none.
inline double volume_below(const Box& box, const Plane& plane) {
  const Vec3 apex = plane.offset * plane.normal;
  double six_volumes = 0;
  for (int side = 0; side < 6; ++side) {
    const int axis = side / 2, b = (axis + 1) % 3, c = (axis + 2) % 3;
    Points polygon(4, box.lower);
    polygon[1][b] = polygon[2][b] = box.upper[b];
    polygon[2][c] = polygon[3][c] = box.upper[c];
    for (Vec3& p : polygon)
      p[axis] = side & 1 ? box.upper[axis] : box.lower[axis];
    const Points kept = clip(polygon, plane);
    for (std::size_t i = 2; i < kept.size(); ++i)
      six_volumes += (side & 1 ? 1 : -1) * (kept[0] - apex).dot((kept[i - 1] - apex).cross(kept[i] - apex));
  }
  return six_volumes / 6;
}

} // namespace kerf::support
