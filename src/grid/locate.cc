#include "grid/locate.h"

#include "base/parallel.h"
#include "grid/cube.h"
#include "grid/material.h"
#include "grid/parts.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <optional>

namespace kerf::grid {

namespace {

/// The smallest barycentric coordinate of p: non-negative inside.
double depth(const Tetrahedron& t, const Vec3& p) {
  Mat3 edges;
  edges << t[1] - t[0], t[2] - t[0], t[3] - t[0];
  const Vec3 b = edges.inverse() * (p - t[0]);
  return std::min(b.minCoeff(), 1 - b.sum());
}

/// The copy of the cell whose material p lies deepest in, p in coordinates of the cell [1]; invalid where p lies deeper
/// among those vertices of the cell (bits) that are not material.
CopyId deepest(const Solid& solid, const CellId c, const unsigned empty, const Vec3& p) {
  CopyId best;
  double greatest = -1e300;
  const auto offer = [&](const Tetrahedron& t, const CopyId copy) {
    if (const double d = depth(t, p); d > greatest) { // false for NaN: a flat tetrahedron holds nothing
      greatest = d;
      best = copy;
    }
  };
  for (const CopyId copy : solid.complex.copies_of(c))
    for_each_tetrahedron(solid, solid.complex.copies[copy], [&](const Tetrahedron& t, int) { offer(t, copy); });
  if (greatest >= 0)
    return best;
  for (int v = 0; v < cube::n_vertices; ++v)
    if (empty >> v & 1)
      for (const Tetrahedron& t : octant(solid, c, v))
        offer(t, CopyId());
  return best;
}

std::optional<CellId> cell_around(const Grid& grid, const Vec3& p) {
  const Vec3 at = ((p - grid.lattice().origin) / grid.h()).array().floor();
  return grid.find_cell({static_cast<int>(at[0]), static_cast<int>(at[1]), static_cast<int>(at[2])});
}

CopyId copy_among(const Solid& solid, const CellId cell, const unsigned empty, const Vec3& p) {
  return solid.cuts.configuration(solid.grid, cell) == 0
           ? solid.complex.first_copy[cell]
           : deepest(solid, cell, empty, (p - solid.grid.origin(cell)) / solid.grid.h());
}

} // namespace

CopyId copy_around(const Solid& solid, const Vec3& p) {
  const auto cell = cell_around(solid.grid, p);
  return cell ? copy_among(solid, *cell, 0xff & ~material_of(solid.grid, *cell), p) : CopyId();
}

std::vector<CopyId> copies_around(const Solid& solid, const Points& points) {
  std::vector<CopyId> copies(points.size());
  parallel_for(
    points.size(),
    [&](const std::size_t i) {
      if (const auto cell = cell_around(solid.grid, points[i]))
        copies[i] = copy_among(solid, *cell, 0, points[i]);
    },
    64);
  return copies;
}

CopyId copy_at(const Solid& solid, const Vec3& p) {
  const double reach = 1e-6 * solid.grid.h(); // what lies on the skin belongs to the body
  CopyId copy = copy_around(solid, p);
  for (int corner = 0; corner < 8 && !copy.valid(); ++corner)
    copy = copy_around(solid, p + reach * Vec3(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1));
  return copy;
}

} // namespace kerf::grid
