#include "cut/cell_triangles.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace kerf::cut {

namespace {

/// Cells in rows along x: those of row (y, z) are begin .. end of a list that ascends by z, then y, then x. The table
/// of rows grows like a body's surface, not like its volume.
class Rows {
 public:
  Rows(const grid::Grid& grid, const std::span<const grid::TouchedCell> cells) {
    std::vector<Index3> indices;
    indices.reserve(cells.size());
    for (const auto& touched : cells)
      indices.push_back(grid.index(grid.nodes(touched.cell)[0]));
    first_ = last_ = indices.empty() ? Index3{} : indices[0];
    for (const Index3& i : indices)
      for (int d = 0; d < 3; ++d) {
        first_[d] = std::min(first_[d], i[d]);
        last_[d] = std::max(last_[d], i[d]);
      }
    start_.assign(row(last_[1], last_[2]) + 2, 0);
    for (const Index3& i : indices) {
      ++start_[row(i[1], i[2]) + 1];
      x_.push_back(i[0]);
    }
    for (std::size_t r = 1; r < start_.size(); ++r)
      start_[r] += start_[r - 1];
  }

  /// Calls f(place in the list, cell's index) for the cells of a box of indices, both ends included.
  template <class Function>
  void for_each(Index3 from, Index3 to, const Function& f) const {
    for (int d = 0; d < 3; ++d) {
      from[d] = std::max(from[d], first_[d]);
      to[d] = std::min(to[d], last_[d]);
    }
    for (int z = from[2]; z <= to[2]; ++z)
      for (int y = from[1]; y <= to[1]; ++y) {
        const std::size_t r = row(y, z);
        const auto end = x_.begin() + start_[r + 1];
        for (auto x = std::lower_bound(x_.begin() + start_[r], end, from[0]); x != end && *x <= to[0]; ++x)
          f(static_cast<std::uint32_t>(x - x_.begin()), Index3{*x, y, z});
      }
  }

 private:
  std::size_t row(const int y, const int z) const {
    return static_cast<std::size_t>(z - first_[2]) * (last_[1] - first_[1] + 1) + (y - first_[1]);
  }

  Index3 first_, last_;
  std::vector<std::uint32_t> start_;
  std::vector<int> x_;
};

Index3 cell_of(const grid::Lattice& lattice, const Vec3& p) {
  Index3 i;
  for (int axis = 0; axis < 3; ++axis) {
    const double x = (p[axis] - lattice.origin[axis]) / lattice.h;
    i[axis] = static_cast<int>(x);
    i[axis] -= x < i[axis]; // down, not towards 0
  }
  return i;
}

/// Calls f(place in the list, triangle) for each triangle and each cell that it may meet.
template <class Function>
void for_each_pair(const Rows& rows, const grid::Lattice& lattice, const std::vector<FlatTriangle>& triangles,
                   const Function& f) {
  constexpr double slack = 1e-6; // parts of h: far more than a vertex on the mesh may be off
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const auto& [a, b, c] = triangles[t].corners;
    const Vec3& n = triangles[t].normal;
    const double reach = (0.5 + slack) * lattice.h * n.lpNorm<1>();
    rows.for_each(cell_of(lattice, a.cwiseMin(b).cwiseMin(c)), cell_of(lattice, a.cwiseMax(b).cwiseMax(c)),
                  [&](const std::uint32_t place, const Index3& i) {
                    const Vec3 middle = lattice.position(i) + Vec3::Constant(0.5 * lattice.h);
                    if (std::abs(triangles[t].height(middle)) <= reach)
                      f(place, t);
                  });
  }
}

} // namespace

CellTriangles::CellTriangles(const geometry::TriangleMesh& mesh, const grid::Grid& grid,
                             const std::span<const grid::TouchedCell> cells)
  : start_(cells.size() + 1, 0) {
  flat_.reserve(mesh.triangles.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto corners = geometry::corners(mesh, t);
    flat_.push_back({(corners[1] - corners[0]).cross(corners[2] - corners[0]), corners});
  }
  std::vector<std::array<std::uint32_t, 2>> pairs;
  pairs.reserve(8 * cells.size());
  for_each_pair(Rows(grid, cells), grid.lattice(), flat_, [&](const std::uint32_t place, const std::uint32_t t) {
    pairs.push_back({place, t});
    ++start_[place + 1];
  });
  for (std::size_t i = 1; i < start_.size(); ++i)
    start_[i] += start_[i - 1];
  triangles_.resize(pairs.size());
  std::vector<std::uint32_t> next(start_.begin(), start_.end() - 1);
  for (const auto& [place, t] : pairs)
    triangles_[next[place]++] = t;
}

} // namespace kerf::cut
