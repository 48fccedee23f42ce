#include "surface/rim.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <utility>

namespace kerf::surface {

namespace {

double height(const Plane& plane, const Vec3& p) { return plane.normal.dot(p - plane.point); }

bool differ(const double a, const double b) { return (a < 0) != (b < 0); }

/// Where the plane crosses the segment from p, at height a, to q, at height b.
Vec3 crossing(const Vec3& p, const double a, const Vec3& q, const double b) { return p + a / (a - b) * (q - p); }

} // namespace

RimPoint meet_line(const Plane& plane, const Vec3& first, const Vec3& corner, const Vec3& second) {
  const double a = height(plane, first), b = height(plane, corner), c = height(plane, second);
  if (differ(a, b))
    return {crossing(first, a, corner, b), 1};
  if (differ(b, c))
    return {crossing(corner, b, second, c), 0};
  if (std::abs(b) <= std::abs(a) && std::abs(b) <= std::abs(c))
    return {corner, 1, false};
  return std::abs(a) < std::abs(c) ? RimPoint{first, 1, false} : RimPoint{second, 0, false};
}

double part_before_line(const Vec3& from, const Vec3& to, const Vec3& first, const Vec3& corner, const Vec3& second,
                        const int normal) {
  const int u = (normal + 1) % 3, v = (normal + 2) % 3;
  const auto turn = [&](const Vec3& p, const Vec3& q) { return p[u] * q[v] - p[v] * q[u]; };
  const Vec3 way = to - from;
  double part = 1;
  for (const auto& [a, b] : {std::pair(first, corner), std::pair(corner, second)}) {
    const Vec3 side = b - a;
    const double sine = turn(way, side);
    if (sine == 0)
      continue;
    const double along = turn(a - from, side) / sine, across = turn(a - from, way) / sine;
    if (along >= 0 && across >= 0 && across <= 1)
      part = std::min(part, along);
  }
  return part;
}

double part_before(const Vec3& from, const Vec3& to, const std::array<Vec3, 3>& triangle) {
  Mat3 sides;
  sides << to - from, triangle[0] - triangle[1], triangle[0] - triangle[2];
  const double determinant = sides.determinant();
  if (determinant == 0)
    return 1;
  const Vec3 start = triangle[0] - from;
  const auto replaced = [&](const int column) {
    Mat3 m = sides;
    m.col(column) = start;
    return m.determinant() / determinant;
  };
  const double along = replaced(0), b = replaced(1), c = replaced(2);
  return along >= 0 && b >= 0 && c >= 0 && b + c <= 1 ? std::min(along, 1.0) : 1;
}

Vec3 rim_in_fan(const Plane& plane, const Vec3& start, const Vec3& end, const Vec3& centre,
                const std::span<const Vec3> spoke_ends) {
  const double at_centre = height(plane, centre);
  const Vec3 along = end - start;
  constexpr double straight = 1e-9; // of the rim's length
  double largest = straight * along.norm();
  Vec3 best = 0.5 * (start + end);
  for (const Vec3& spoke_end : spoke_ends) {
    const double at_end = height(plane, spoke_end);
    if (!differ(at_centre, at_end))
      continue;
    const Vec3 p = crossing(centre, at_centre, spoke_end, at_end);
    const double part = along.squaredNorm() > 0 ? (p - start).dot(along) / along.squaredNorm() : 0;
    if (const double bend = (p - start - part * along).norm(); bend > largest) {
      largest = bend;
      best = p;
    }
  }
  return best;
}

} // namespace kerf::surface
