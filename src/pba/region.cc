#include "pba/region.h"

#include "base/parallel.h"
#include "grid/cube.h"
#include "grid/material.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <optional>

namespace kerf::pba {

namespace {

using Tetrahedron = std::array<Vec3, 4>;

/// The smallest barycentric coordinate of p: non-negative inside.
double depth(const Tetrahedron& t, const Vec3& p) {
  Mat3 edges;
  edges << t[1] - t[0], t[2] - t[0], t[3] - t[0];
  const Vec3 b = edges.inverse() * (p - t[0]);
  return std::min(b.minCoeff(), 1 - b.sum());
}

/// The copy of the cell whose material p lies deepest in, p in coordinates of the cell [1]; invalid where p lies deeper
/// among those vertices of the cell (bits) that are not material.
grid::CopyId deepest(const grid::Grid& grid, const grid::Cuts& cuts, const grid::CellComplex& complex,
                     const grid::CellId c, const unsigned empty, const Vec3& p) {
  grid::CopyId best;
  double greatest = -1e300;
  const auto offer = [&](const Tetrahedron& t, const grid::CopyId copy) {
    if (const double d = depth(t, p); d > greatest) { // false for NaN: a flat tetrahedron holds nothing
      greatest = d;
      best = copy;
    }
  };
  for (const grid::CopyId copy : complex.copies_of(c))
    grid::for_each_tetrahedron(grid, cuts, complex.copies[copy], [&](const Tetrahedron& t, int) { offer(t, copy); });
  if (greatest >= 0)
    return best;
  for (int v = 0; v < grid::cube::n_vertices; ++v)
    if (empty >> v & 1)
      for (const Tetrahedron& t : grid::octant(grid, cuts, c, v))
        offer(t, grid::CopyId());
  return best;
}

/// Halves a tetrahedron across its longest edge until it is no wider than `size`.
void split(const Tetrahedron& t, const double volume, const double size, std::vector<Crumb>& parts) {
  double longest = 0;
  int a = 0, b = 1;
  for (int i = 0; i < 4; ++i)
    for (int j = i + 1; j < 4; ++j)
      if (const double length = (t[i] - t[j]).squaredNorm(); length > longest) {
        longest = length;
        a = i;
        b = j;
      }
  if (longest <= size * size) {
    parts.push_back({0.25 * (t[0] + t[1] + t[2] + t[3]), volume});
    return;
  }
  Tetrahedron lower = t, upper = t;
  lower[b] = upper[a] = 0.5 * (t[a] + t[b]);
  split(lower, 0.5 * volume, size, parts);
  split(upper, 0.5 * volume, size, parts);
}

/// Tetrahedra between cuts and skin may be negative (grid/material.h): the others are scaled to the copy's volume.
void split_material(const grid::Grid& grid, const grid::Cuts& cuts, const grid::Copy& copy, const double size,
                    std::vector<Crumb>& parts) {
  double sum = 0, positive = 0;
  grid::for_each_tetrahedron(grid, cuts, copy, [&](const Tetrahedron& t, int) {
    sum += grid::volume(t);
    positive += std::max(0.0, grid::volume(t));
  });
  if (sum <= 0)
    return;
  constexpr double negligible = 1e-12; // of h^3: flat ones
  grid::for_each_tetrahedron(grid, cuts, copy, [&](const Tetrahedron& local, int) {
    if (grid::volume(local) < negligible)
      return;
    Tetrahedron t;
    for (int i = 0; i < 4; ++i)
      t[i] = grid.origin(copy.cell) + grid.h() * local[i];
    split(t, sum / positive * grid::volume(t), size, parts);
  });
}

void split_cell(const grid::Grid& grid, const grid::CellId c, const double size, std::vector<Crumb>& parts) {
  const int n = std::max(1, static_cast<int>(std::ceil(grid.h() * std::sqrt(3.0) / size)));
  const double edge = grid.h() / n;
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        parts.push_back({grid.origin(c) + edge * Vec3(i + 0.5, j + 0.5, k + 0.5), edge * edge * edge});
}

std::optional<grid::CellId> cell_around(const grid::Grid& grid, const Vec3& p) {
  const Vec3 at = ((p - grid.lattice().origin) / grid.h()).array().floor();
  return grid.find_cell({static_cast<int>(at[0]), static_cast<int>(at[1]), static_cast<int>(at[2])});
}

unsigned material_vertices(const grid::Grid& grid, const grid::CellId c) {
  unsigned vertices = 0;
  for (int v = 0; v < grid::cube::n_vertices; ++v)
    vertices |= unsigned(grid.is_material(grid.nodes(c)[v])) << v;
  return vertices;
}

grid::CopyId copy_among(const grid::Grid& grid, const grid::Cuts& cuts, const grid::CellComplex& complex,
                        const grid::CellId cell, const unsigned empty, const Vec3& p) {
  return cuts.configuration(grid, cell) == 0
           ? complex.first_copy[cell]
           : deepest(grid, cuts, complex, cell, empty, (p - grid.origin(cell)) / grid.h());
}

} // namespace

grid::CopyId copy_around(const grid::Grid& grid, const grid::Cuts& cuts, const grid::CellComplex& complex,
                         const Vec3& p) {
  const auto cell = cell_around(grid, p);
  return cell ? copy_among(grid, cuts, complex, *cell, 0xff & ~material_vertices(grid, *cell), p) : grid::CopyId();
}

std::vector<grid::CopyId> copies_around(const grid::Grid& grid, const grid::Cuts& cuts,
                                        const grid::CellComplex& complex, const Points& points) {
  std::vector<grid::CopyId> copies(points.size());
  parallel_for(
    points.size(),
    [&](const std::size_t i) {
      if (const auto cell = cell_around(grid, points[i]))
        copies[i] = copy_among(grid, cuts, complex, *cell, 0, points[i]);
    },
    64);
  return copies;
}

std::vector<Crumb> crumbs(const grid::Grid& grid, const grid::Cuts& cuts, const grid::CellComplex& complex,
                          const double size) {
  std::vector<Crumb> parts;
  for (const grid::Copy& copy : complex.copies)
    if (cuts.configuration(grid, copy.cell) == 0)
      split_cell(grid, copy.cell, size, parts);
    else
      split_material(grid, cuts, copy, size, parts);
  return parts;
}

Box bounds(const grid::Grid& grid, const grid::Cuts& cuts, const grid::CellComplex& complex) {
  Box box{Vec3::Constant(1e300), Vec3::Constant(-1e300)};
  for (const grid::Copy& copy : complex.copies)
    grid::for_each_tetrahedron(grid, cuts, copy, [&](const Tetrahedron& t, int) {
      for (const Vec3& p : t)
        box = {box.lower.cwiseMin(p * grid.h() + grid.origin(copy.cell)),
               box.upper.cwiseMax(p * grid.h() + grid.origin(copy.cell))};
    });
  return box;
}

} // namespace kerf::pba
