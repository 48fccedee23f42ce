#pragma once

/// Points that follow corners: the rows of a sparse matrix W, x_point = W x_corners; a surface by its vertices, places
/// in a body, points of files. Forces on them go to the corners by the transpose, so that power, and with weights that
/// sum to 1 momentum too, are the same on both sides.

#include "base/sparse_rows.h"
#include "base/vec.h"

namespace kerf {

struct Interpolation : SparseRows<double> {
  std::size_t n_points() const { return n_rows(); }

  /// What the corners have, at point i.
  Vec3 at(const std::size_t i, const Points& of_corners) const {
    Vec3 sum = Vec3::Zero();
    for (auto k = start[i]; k < start[i + 1]; ++k)
      sum += values[k] * of_corners[columns[k]];
    return sum;
  }

  /// Puts a force at point i on its corners.
  void add_force(const std::size_t i, const Vec3& force, Points& forces) const {
    for (auto k = start[i]; k < start[i + 1]; ++k)
      forces[columns[k]] += values[k] * force;
  }
};

/// Each corner by itself.
inline Interpolation corners_themselves(const std::size_t n_corners) {
  Interpolation points;
  for (std::uint32_t c = 0; c < n_corners; ++c) {
    points.add_entry(c, 1);
    points.end_row();
  }
  return points;
}

} // namespace kerf
