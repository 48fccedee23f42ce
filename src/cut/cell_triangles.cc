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
    x_.reserve(indices.size());
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

/// Calls f(place in the list) for each cell that a triangle may meet.
template <class Function>
void for_each_cell(const Rows& rows, const grid::Lattice& lattice, const FlatTriangle& triangle, const Function& f) {
  constexpr double slack = 1e-6; // parts of h: far more than a vertex on the mesh may be off, or round-off be
  const auto& [a, b, c] = triangle.corners;
  const Vec3 step = lattice.h * triangle.normal; // of the height, from cell to cell
  const double reach = (0.5 + slack) * step.lpNorm<1>();
  const double middle = triangle.height(lattice.origin) + 0.5 * step.sum(); // of cell (0, 0, 0)
  rows.for_each(cell_of(lattice, a.cwiseMin(b).cwiseMin(c)), cell_of(lattice, a.cwiseMax(b).cwiseMax(c)),
                [&](const std::uint32_t place, const Index3& i) {
                  if (std::abs(middle + i[0] * step[0] + (i[1] * step[1] + i[2] * step[2])) <= reach)
                    f(place);
                });
}

} // namespace

void TriangleGroup::push_back(const FlatTriangle& triangle) {
  const auto& [a, b, c] = triangle.corners;
  const Vec3 e = b - a, f = c - a;
  for (int i = 0; i < 3; ++i) {
    a_[i][n_] = a[i];
    e_[i][n_] = e[i];
    f_[i][n_] = f[i];
    normal_[i][n_] = triangle.normal[i];
  }
  length_[n_] = e.lpNorm<1>() + f.lpNorm<1>();
  area2_[n_++] = triangle.normal.squaredNorm();
}

std::uint32_t TriangleGroup::which_may_meet(const Vec3& p, const Vec3& d, const double room,
                                            const double tolerance) const {
  constexpr double roundoff = 1e-9;
  const double px = p[0], py = p[1], pz = p[2], dx = d[0], dy = d[1], dz = d[2];
  const double near2 = (1 + 1e-6) * tolerance * tolerance;
  Column in_u, in_v, in_w, above; // not negative: on the right side of each side, near the plane
  for (std::size_t i = 0; i < n_; ++i) {
    const double ex = e_[0][i], ey = e_[1][i], ez = e_[2][i], fx = f_[0][i], fy = f_[1][i], fz = f_[2][i];
    const double apx = px - a_[0][i], apy = py - a_[1][i], apz = pz - a_[2][i];
    const double dfx = dy * fz - dz * fy, dfy = dz * fx - dx * fz, dfz = dx * fy - dy * fx;
    const double determinant = ex * dfx + ey * dfy + ez * dfz, sign = std::copysign(1.0, determinant);
    const double u = sign * (apx * dfx + apy * dfy + apz * dfz);
    const double v = sign * (dx * (apy * ez - apz * ey) + dy * (apz * ex - apx * ez) + dz * (apx * ey - apy * ex));
    const double doubt = roundoff * length_[i] * (length_[i] + room);
    const double height = normal_[0][i] * apx + normal_[1][i] * apy + normal_[2][i] * apz;
    in_u[i] = u + doubt;
    in_v[i] = v + doubt;
    in_w[i] = sign * determinant - u - v + doubt;
    above[i] = near2 * area2_[i] - height * height;
  }
  std::uint32_t may_meet = 0;
  for (std::size_t i = 0; i < n_; ++i)
    may_meet |= std::uint32_t(((in_u[i] >= 0) & (in_v[i] >= 0) & (in_w[i] >= 0)) | (above[i] >= 0)) << i;
  return may_meet;
}

CellTriangles::CellTriangles(const geometry::TriangleMesh& mesh, const grid::Grid& grid,
                             const std::span<const grid::TouchedCell> cells)
  : start_(cells.size() + 1, 0) {
  const Rows rows(grid, cells);
  std::vector<std::uint32_t> places, end_of; // the cells of one triangle after the other, and where they end
  places.reserve(6 * cells.size());
  end_of.reserve(mesh.triangles.size());
  flat_.reserve(mesh.triangles.size());
  for (const auto& [i, j, k] : mesh.triangles) {
    const Vec3 &a = mesh.vertices[i], &b = mesh.vertices[j], &c = mesh.vertices[k];
    flat_.push_back({(b - a).cross(c - a), {a, b, c}});
    for_each_cell(rows, grid.lattice(), flat_.back(), [&](const std::uint32_t place) {
      places.push_back(place);
      ++start_[place + 1];
    });
    end_of.push_back(static_cast<std::uint32_t>(places.size()));
  }
  for (std::size_t i = 1; i < start_.size(); ++i)
    start_[i] += start_[i - 1];
  triangles_.resize(places.size());
  std::vector<std::uint32_t> next(start_.begin(), start_.end() - 1);
  for (std::uint32_t t = 0, i = 0; t < end_of.size(); ++t)
    for (; i < end_of[t]; ++i)
      triangles_[next[places[i]]++] = t;
}

} // namespace kerf::cut
