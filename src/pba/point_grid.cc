#include "pba/point_grid.h"

#include <algorithm>
#include <cmath>

namespace kerf::pba {

PointGrid::PointGrid(const Points& points, const double cell)
  : points_(points), box_{Vec3::Zero(), Vec3::Zero()}, cell_(cell) {
  if (!points.empty())
    box_ = {points[0], points[0]};
  for (const Vec3& p : points)
    box_ = {box_.lower.cwiseMin(p), box_.upper.cwiseMax(p)};
  const Vec3 size = box_.upper - box_.lower;
  const double most = 8.0 * static_cast<double>(points.size()) + 64;
  while ((size.array() / cell_ + 1).prod() > most)
    cell_ *= 1.25;
  for (int axis = 0; axis < 3; ++axis)
    n_[axis] = 1 + static_cast<int>(size[axis] / cell_);

  const auto cube_number = [&](const Vec3& p) {
    const Index3 i = cube(p);
    return static_cast<std::size_t>(i[0]) + n_[0] * (static_cast<std::size_t>(i[1]) + n_[1] * std::size_t(i[2]));
  };
  start_.assign(std::size_t(n_[0]) * n_[1] * n_[2] + 1, 0);
  for (const Vec3& p : points)
    ++start_[cube_number(p) + 1];
  for (std::size_t c = 1; c < start_.size(); ++c)
    start_[c] += start_[c - 1];
  items_.resize(points.size());
  std::vector<std::uint32_t> next(start_.begin(), start_.end() - 1);
  for (std::uint32_t i = 0; i < points.size(); ++i)
    items_[next[cube_number(points[i])]++] = i;
}

Index3 PointGrid::cube(const Vec3& p) const {
  Index3 i;
  for (int axis = 0; axis < 3; ++axis)
    i[axis] = static_cast<int>(std::clamp(std::floor((p[axis] - box_.lower[axis]) / cell_), 0.0, double(n_[axis] - 1)));
  return i;
}

void PointGrid::within(const Vec3& p, const double radius, std::vector<std::uint32_t>& found) const {
  found.clear();
  const Index3 lower = cube(p - Vec3::Constant(radius)), upper = cube(p + Vec3::Constant(radius));
  for (int k = lower[2]; k <= upper[2]; ++k)
    for (int j = lower[1]; j <= upper[1]; ++j) {
      const std::size_t row = n_[0] * (static_cast<std::size_t>(j) + n_[1] * std::size_t(k));
      for (auto at = start_[row + lower[0]]; at < start_[row + upper[0] + 1]; ++at)
        if ((points_[items_[at]] - p).norm() < radius)
          found.push_back(items_[at]);
    }
  std::sort(found.begin(), found.end());
}

std::uint32_t PointGrid::nearest(const Vec3& p) const {
  std::vector<std::uint32_t> found;
  for (double radius = cell_; found.empty(); radius *= 2)
    within(p, radius, found);
  return *std::min_element(found.begin(), found.end(), [&](const std::uint32_t i, const std::uint32_t j) {
    return (points_[i] - p).squaredNorm() < (points_[j] - p).squaredNorm();
  });
}

std::vector<double> PointGrid::nearest_distances(const Vec3& p, const std::size_t n) const {
  const std::size_t wanted = std::min(n, points_.size());
  std::vector<std::uint32_t> found;
  for (double radius = cell_; found.size() < wanted; radius *= 2)
    within(p, radius, found);
  std::vector<double> distances;
  for (const auto i : found)
    distances.push_back((points_[i] - p).norm());
  std::partial_sort(distances.begin(), distances.begin() + wanted, distances.end());
  distances.resize(wanted);
  return distances;
}

} // namespace kerf::pba
