#pragma once

/// Points sorted into cubes, for queries by distance.

#include "base/vec.h"

#include <cstdint>
#include <vector>

namespace kerf::pba {

class PointGrid {
 public:
  /// The points must outlive the grid. `cell`: edge of a cube [m], about the radius of the queries; larger where the
  /// points are so scattered that most cubes would be empty.
  PointGrid(const Points& points, double cell);

  /// The points closer to p than `radius` [m], in ascending order.
  void within(const Vec3& p, double radius, std::vector<std::uint32_t>& found) const;
  /// The point nearest to p, the first of equally near ones. There must be one.
  std::uint32_t nearest(const Vec3& p) const;
  /// The distances from p to its n nearest points [m], ascending; fewer when there are fewer points.
  std::vector<double> nearest_distances(const Vec3& p, std::size_t n) const;

 private:
  Index3 cube(const Vec3& p) const;

  const Points& points_;
  Box box_;
  double cell_;
  Index3 n_ = {1, 1, 1};
  std::vector<std::uint32_t> start_, items_;
};

} // namespace kerf::pba
