#include "surface/below_skin.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <utility>

namespace kerf::surface {

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

} // namespace kerf::surface
