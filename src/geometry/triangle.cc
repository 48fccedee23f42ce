#include "geometry/triangle.h"

#include <Eigen/Geometry>

#include <algorithm>

namespace kerf::geometry {

namespace {

Vec3 closest_on_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const double length2 = (b - a).squaredNorm();
  return length2 == 0 ? a : Vec3(a + std::clamp((p - a).dot(b - a) / length2, 0.0, 1.0) * (b - a));
}

} // namespace

Vec3 closest_point(const Vec3& p, const std::array<Vec3, 3>& triangle) {
  const auto& [a, b, c] = triangle;
  const Vec3 n = (b - a).cross(c - a);
  const bool inside = n.squaredNorm() > 0 && n.dot((b - a).cross(p - a)) >= 0 && n.dot((c - b).cross(p - b)) >= 0 &&
                      n.dot((a - c).cross(p - c)) >= 0;
  if (inside)
    return p - n * (n.dot(p - a) / n.squaredNorm());
  const std::array<Vec3, 3> candidates = {closest_on_segment(p, a, b), closest_on_segment(p, b, c),
                                          closest_on_segment(p, c, a)};
  return *std::min_element(candidates.begin(), candidates.end(),
                           [&](const Vec3& q, const Vec3& r) { return (q - p).squaredNorm() < (r - p).squaredNorm(); });
}

std::optional<Vec3> closest_point_in_plane(const Vec3& p, const int axis, const std::array<Vec3, 3>& triangle) {
  Points ends;
  for (int i = 0; i < 3; ++i) {
    const Vec3 &a = triangle[i], &b = triangle[(i + 1) % 3];
    const double above_a = a[axis] - p[axis], above_b = b[axis] - p[axis];
    if ((above_a < 0) != (above_b < 0))
      ends.push_back(a + above_a / (above_a - above_b) * (b - a));
  }
  if (ends.size() != 2)
    return std::nullopt;
  Vec3 nearest = closest_on_segment(p, ends[0], ends[1]);
  nearest[axis] = p[axis];
  return nearest;
}

std::optional<double> line_meets(const Vec3& p, const Vec3& d, const std::array<Vec3, 3>& triangle) {
  const auto& [a, b, c] = triangle;
  const Vec3 e = b - a, f = c - a, df = d.cross(f);
  const double determinant = e.dot(df);
  if (determinant == 0)
    return std::nullopt;
  const Vec3 ap = p - a;
  const Vec3 across = ap.cross(e);
  const double u = ap.dot(df) / determinant, v = d.dot(across) / determinant;
  constexpr double slack = 1e-12; // a hit on the seam of two triangles is a hit
  const int n_outside = int(u < -slack) + int(v < -slack) + int(u + v > 1 + slack); // one branch instead of three
  if (n_outside != 0)
    return std::nullopt;
  return f.dot(across) / determinant;
}

} // namespace kerf::geometry
