#include "geometry/predicates.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Exact_rational.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

namespace kerf::geometry {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

constexpr int next(const int axis) { return (axis + 1) % 3; }

int sign(const double x) { return (x > 0) - (x < 0); }

/// Is left - right, of two rounded products of rounded differences, large enough to have the sign of the exact one?
bool is_certain(const double left, const double right) {
  constexpr double safety = 8 * std::numeric_limits<double>::epsilon();
  return std::abs(left - right) > safety * (std::abs(left) + std::abs(right));
}

int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p) {
  const auto point = [](const Vec3& v) { return Kernel::Point_3(v[0], v[1], v[2]); };
  return CGAL::orientation(point(a), point(b), point(c), point(p));
}

/// Sign of component `axis` of (b-a) x (c-a): the orientation of the three points seen along the axis.
int normal_sign(const int axis, const Vec3& a, const Vec3& b, const Vec3& c) {
  const int i = next(axis), j = next(i);
  const double left = (b[i] - a[i]) * (c[j] - a[j]), right = (b[j] - a[j]) * (c[i] - a[i]);
  if (is_certain(left, right))
    return sign(left - right);
  const auto point = [i, j](const Vec3& v) { return Kernel::Point_2(v[i], v[j]); };
  return CGAL::orientation(point(a), point(b), point(c));
}

/// Sign of component `axis` of (q-p) x (a-b).
int cross_sign(const int axis, const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b) {
  const int i = next(axis), j = next(i);
  const double ui = q[i] - p[i], uj = q[j] - p[j], vi = a[i] - b[i], vj = a[j] - b[j];
  // A rounded difference is 0 only if the exact one is, so signs of products with a factor 0 are exact.
  const int first = sign(ui) * sign(vj), second = sign(uj) * sign(vi);
  if (first != second)
    return first > second ? 1 : -1;
  if (first == 0)
    return 0;
  if (is_certain(ui * vj, uj * vi))
    return sign(ui * vj - uj * vi);

  using Exact = CGAL::Exact_rational;
  // Named results: the number type may be one of expression templates.
  const auto minus = [](const double x, const double y) -> Exact { return Exact(x) - Exact(y); };
  const Exact left = minus(q[i], p[i]) * minus(a[j], b[j]), right = minus(q[j], p[j]) * minus(a[i], b[i]);
  return CGAL::compare(left, right);
}

/// On which side of the displaced edge ab the line pq passes; 0 only when the two are parallel.
int edge_side(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b) {
  int s = orientation(p, q, a, b);
  for (int axis = 0; axis < 3 && s == 0; ++axis)
    s = cross_sign(axis, p, q, a, b);
  return s;
}

/// edge_side() for the line through p upwards along `axis`.
int line_edge_side(const Vec3& p, const int axis, const Vec3& a, const Vec3& b) {
  if (const int s = normal_sign(axis, p, a, b); s != 0)
    return s;
  const int i = next(axis), j = next(i);
  const int of_i = sign(b[j] - a[j]), of_j = sign(a[i] - b[i]); // factors of d_i and d_j
  const int first = i < j ? of_i : of_j, second = i < j ? of_j : of_i;
  return first != 0 ? first : second;
}

} // namespace

int side(const Vec3& p, const std::array<Vec3, 3>& triangle) {
  const auto& [a, b, c] = triangle;
  int s = orientation(a, b, c, p);
  for (int axis = 0; axis < 3 && s == 0; ++axis)
    s = -normal_sign(axis, a, b, c);
  return s;
}

bool crosses(const Vec3& p, const Vec3& q, const std::array<Vec3, 3>& triangle) {
  if (side(p, triangle) == side(q, triangle))
    return false;
  const auto& [a, b, c] = triangle;
  const int s = edge_side(p, q, a, b);
  return s == edge_side(p, q, b, c) && s == edge_side(p, q, c, a);
}

int line_crosses(const Vec3& p, const int axis, const std::array<Vec3, 3>& triangle) {
  const auto& [a, b, c] = triangle;
  const int s = line_edge_side(p, axis, a, b);
  return s == line_edge_side(p, axis, b, c) && s == line_edge_side(p, axis, c, a) ? s : 0;
}

double crossing_parameter(const Vec3& p, const Vec3& q, const std::array<Vec3, 3>& triangle) {
  const Vec3 normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]);
  const double at_p = normal.dot(p - triangle[0]), at_q = normal.dot(q - triangle[0]);
  const double t = at_p / (at_p - at_q);
  return std::isfinite(t) ? std::clamp(t, 0.0, 1.0) : 0.5; // not finite: all of pq is on the triangle, but for rounding
}

Vec3 unit_normal(const std::array<Vec3, 3>& triangle) {
  return (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]).normalized();
}

} // namespace kerf::geometry
