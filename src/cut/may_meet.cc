#include "cut/may_meet.h"

#include <algorithm>
#include <cmath>

namespace kerf::cut {

namespace {

constexpr double roundoff = 1e-13; // some hundred times what the sums below can lose

double sum_of_sizes(const Vec3& v) { return v.cwiseAbs().sum(); }

} // namespace

Interval::Interval(const std::span<const Vec3> points, const Vec3& axis) {
  for (const Vec3& p : points) {
    const double at = axis.dot(p);
    low = std::min(low, at);
    high = std::max(high, at);
    size = std::max(size, sum_of_sizes(p));
  }
}

Interval::Interval(const Box& box, const Vec3& axis) {
  const double middle = axis.dot(0.5 * (box.lower + box.upper));
  const double half = axis.cwiseAbs().dot(0.5 * (box.upper - box.lower));
  low = middle - half;
  high = middle + half;
  size = sum_of_sizes(box.lower) + sum_of_sizes(box.upper);
}

bool are_apart(const Interval& a, const Interval& b, const Vec3& axis) {
  const double gap = roundoff * sum_of_sizes(axis) * (a.size + b.size);
  return a.low > b.high + gap || b.low > a.high + gap;
}

bool may_meet(const Vec3& point, const Vec3& normal, const Box& box) {
  return !are_apart(Interval(std::span(&point, 1), normal), Interval(box, normal), normal);
}

bool are_apart(const std::span<const Vec3> a, const std::span<const Vec3> b, const Vec3& axis) {
  return are_apart(Interval(a, axis), Interval(b, axis), axis);
}

std::array<Vec3, 8> corners_of(const Box& box) {
  std::array<Vec3, 8> corners;
  for (int v = 0; v < 8; ++v)
    for (int axis = 0; axis < 3; ++axis)
      corners[v][axis] = v >> axis & 1 ? box.upper[axis] : box.lower[axis];
  return corners;
}

} // namespace kerf::cut
