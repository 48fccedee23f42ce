#pragma once

/// Points that follow corners: the rows of a sparse matrix W, x_point = W x_corners; a surface by its vertices, places
/// in a body, points of files. Forces on them go to the corners by the transpose, so that power, and with weights that
/// sum to 1 momentum too, are the same on both sides.

#include "base/archive.h"
#include "base/vec.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace kerf {

struct Interpolation {
  std::vector<std::uint32_t> start = {0}; ///< of each point's entries, and their end
  std::vector<std::uint32_t> corners = {};
  std::vector<double> values = {}; ///< [1]

  void archive(Archive& a) { a(start, corners, values); }
  std::size_t n_points() const { return start.size() - 1; }

  void add_point(const std::span<const std::uint32_t> of_corners, const std::span<const double> of_weights) {
    corners.insert(corners.end(), of_corners.begin(), of_corners.end());
    values.insert(values.end(), of_weights.begin(), of_weights.end());
    start.push_back(static_cast<std::uint32_t>(corners.size()));
  }

  /// What the corners have, at point i.
  Vec3 at(const std::size_t i, const Points& of_corners) const {
    Vec3 sum = Vec3::Zero();
    for (auto k = start[i]; k < start[i + 1]; ++k)
      sum += values[k] * of_corners[corners[k]];
    return sum;
  }

  /// Puts a force at point i on its corners.
  void add_force(const std::size_t i, const Vec3& force, Points& forces) const {
    for (auto k = start[i]; k < start[i + 1]; ++k)
      forces[corners[k]] += values[k] * force;
  }
};

/// Each corner by itself.
inline Interpolation corners_themselves(const std::size_t n_corners) {
  Interpolation points;
  for (std::uint32_t c = 0; c < n_corners; ++c) {
    const double one = 1;
    points.add_point({&c, 1}, {&one, 1});
  }
  return points;
}

} // namespace kerf
