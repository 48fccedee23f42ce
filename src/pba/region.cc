#include "pba/region.h"

#include "base/parallel.h"
#include "grid/cube.h"

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

/// The vertex, among the given ones (bits), whose octant p lies deepest in; p in coordinates of the cell [1].
int octant_around(const grid::Grid& grid, const grid::Cuts& cuts, const grid::CellId c, const unsigned vertices,
                  const Vec3& p) {
  int best = 0;
  double greatest = -1e300;
  for (int v = 0; v < grid::cube::n_vertices; ++v) {
    if (!(vertices >> v & 1))
      continue;
    for (const Tetrahedron& t : grid::octant(grid, cuts, c, v))
      if (const double d = depth(t, p); d > greatest) { // false for NaN: a flat tetrahedron holds nothing
        greatest = d;
        best = v;
      }
  }
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

void split_octant(const grid::Grid& grid, const grid::Cuts& cuts, const grid::CellId c, const int vertex,
                  const double size, std::vector<Crumb>& parts) {
  for (const Tetrahedron& local : grid::octant(grid, cuts, c, vertex)) {
    Tetrahedron t;
    for (int i = 0; i < 4; ++i)
      t[i] = grid.origin(c) + grid.h() * local[i];
    const double volume = (t[1] - t[0]).dot((t[2] - t[0]).cross(t[3] - t[0])) / 6;
    split(t, volume, size, parts);
  }
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

/// The copy at the vertex, among the given ones, whose octant p lies deepest in.
grid::CopyId copy_among(const grid::Grid& grid, const grid::Cuts& cuts, const grid::CellComplex& complex,
                        const grid::CellId cell, const unsigned vertices, const Vec3& p) {
  const bool whole = cuts.configuration(grid, cell) == 0;
  return complex.copy_at(cell,
                         whole ? 0 : octant_around(grid, cuts, cell, vertices, (p - grid.origin(cell)) / grid.h()));
}

} // namespace

grid::CopyId copy_around(const grid::Grid& grid, const grid::Cuts& cuts, const grid::CellComplex& complex,
                         const Vec3& p) {
  const auto cell = cell_around(grid, p);
  return cell ? copy_among(grid, cuts, complex, *cell, 0xff, p) : grid::CopyId();
}

std::vector<grid::CopyId> copies_around(const grid::Grid& grid, const grid::Cuts& cuts,
                                        const grid::CellComplex& complex, const Points& points) {
  std::vector<grid::CopyId> copies(points.size());
  parallel_for(
    points.size(),
    [&](const std::size_t i) {
      if (const auto cell = cell_around(grid, points[i]))
        copies[i] = copy_among(grid, cuts, complex, *cell, material_vertices(grid, *cell), points[i]);
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
      for (int v = 0; v < grid::cube::n_vertices; ++v)
        if (copy.nodes >> v & 1)
          split_octant(grid, cuts, copy.cell, v, size, parts);
  return parts;
}

Box bounds(const grid::Grid& grid, const grid::Cuts& cuts, const grid::CellComplex& complex) {
  Box box{Vec3::Constant(1e300), Vec3::Constant(-1e300)};
  for (const grid::Copy& copy : complex.copies)
    for (int v = 0; v < grid::cube::n_vertices; ++v)
      if (copy.nodes >> v & 1)
        for (const Tetrahedron& t : grid::octant(grid, cuts, copy.cell, v))
          for (const Vec3& p : t)
            box = {box.lower.cwiseMin(p * grid.h() + grid.origin(copy.cell)),
                   box.upper.cwiseMax(p * grid.h() + grid.origin(copy.cell))};
  return box;
}

} // namespace kerf::pba
