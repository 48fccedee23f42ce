#include "pba/region.h"

#include "grid/material.h"

#include <algorithm>
#include <cmath>

namespace kerf::pba {

namespace {

using grid::Tetrahedron;

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

/// Some tetrahedra may be negative, though not their sum (grid/material.h): the others are scaled to that.
void split_material(const grid::Solid& solid, const grid::Copy& copy, const double size, std::vector<Crumb>& parts) {
  double sum = 0, positive = 0;
  grid::for_each_tetrahedron(solid, copy, [&](const Tetrahedron& t, int) {
    sum += grid::volume(t);
    positive += std::max(0.0, grid::volume(t));
  });
  if (sum <= 0)
    return;
  constexpr double negligible = 1e-12; // of h^3: flat ones
  grid::for_each_tetrahedron(solid, copy, [&](const Tetrahedron& local, int) {
    if (grid::volume(local) < negligible)
      return;
    Tetrahedron t;
    for (int i = 0; i < 4; ++i)
      t[i] = solid.grid.origin(copy.cell) + solid.grid.h() * local[i];
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

} // namespace

std::vector<Crumb> crumbs(const grid::Solid& solid, const double size) {
  std::vector<Crumb> parts;
  for (const grid::Copy& copy : solid.complex.copies)
    if (solid.cuts.configuration(solid.grid, copy.cell) == 0)
      split_cell(solid.grid, copy.cell, size, parts);
    else
      split_material(solid, copy, size, parts);
  return parts;
}

Box bounds(const grid::Solid& solid) {
  Box box{Vec3::Constant(1e300), Vec3::Constant(-1e300)};
  for (const grid::Copy& copy : solid.complex.copies)
    grid::for_each_tetrahedron(solid, copy, [&](const Tetrahedron& t, int) {
      for (const Vec3& p : t)
        box = {box.lower.cwiseMin(p * solid.grid.h() + solid.grid.origin(copy.cell)),
               box.upper.cwiseMax(p * solid.grid.h() + solid.grid.origin(copy.cell))};
    });
  return box;
}

} // namespace kerf::pba
