#include "cut/openings.h"

#include "cut/cell_at_plane.h"
#include "grid/shape.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace kerf::cut {

namespace {

using grid::CellId;
using grid::Solid;
namespace cube = grid::cube;

constexpr double least_open = 1e-3, most_open = 0.999;

/// In the octant (bits for the upper side along x, y, z) around a vertex of a cell; not valid outside of the grid.
CellId cell_around(const grid::Grid& grid, const CellId own, const int v, const int octant) {
  CellId c = own;
  for (int axis = 0; axis < 3 && c.valid(); ++axis)
    if ((v >> axis & 1) == (octant >> axis & 1))
      c = v >> axis & 1 ? grid.neighbour(c, 2 * axis + 1) : grid.neighbour(c, 2 * axis);
  return c;
}

/// Which of a cell's vertices the one is that it has in this octant.
int vertex_in(const int octant) { return octant ^ (cube::n_vertices - 1); }

} // namespace

double held(const double area, const double part, const double h) {
  constexpr double least_area = 1e-6;
  const double open = 1 - std::sqrt(std::clamp(2 * (1 - part), 0.0, 1.0)), f = std::clamp(open, least_open, most_open);
  return std::max(area, least_area * h * h) / 3 * (1 - f) / f;
}

ToRest::ToRest(const Solid& solid, const CellId c, const Points& x) : origin(solid.grid.origin(c)) {
  const grid::Copy& copy = solid.complex.copies[solid.complex.first_copy[c]];
  Mat3 along = Mat3::Zero();
  for (int v = 0; v < 8; ++v) {
    const Vec3& p = x[copy.corners[v].value];
    middle += p / 8;
    for (int axis = 0; axis < 3; ++axis)
      along.col(axis) += ((v >> axis & 1) != 0 ? 0.25 : -0.25) * p;
  }
  const double h = solid.grid.h();
  bool invertible = false;
  Mat3 inverse;
  along.computeInverseWithCheck(inverse, invertible, 1e-6 * h * h * h);
  from = invertible ? Mat3(h * inverse) : Mat3(Mat3::Zero());
  origin += Vec3::Constant(0.5 * h);
}

/// By the middles of the sides of small triangles: exact in planes along the grid.
void add_integrals(const Solid& solid, const CellId c, const Polygon& polygon, OfVertices& sums) {
  constexpr int m = 2; // along each side
  const double h = solid.grid.h();
  const Vec3 origin = solid.grid.origin(c);
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    const Vec3 p = (polygon[0] - origin) / h, u = (polygon[i - 1] - polygon[0]) / (m * h),
               w = (polygon[i] - polygon[0]) / (m * h);
    const double part = 0.5 / 3 * h * h * u.cross(w).norm();
    const auto add = [&](const double j, const double k) {
      const Vec3 xi = p + j * u + k * w;
      for (int v = 0; v < cube::n_vertices; ++v)
        sums[v] += part * grid::shape(v, xi);
    };
    const auto add_triangle = [&](const double j, const double k, const double side) {
      add(j + 0.5 * side, k);
      add(j, k + 0.5 * side);
      add(j + 0.5 * side, k + 0.5 * side);
    };
    for (int j = 0; j < m; ++j)
      for (int k = 0; j + k < m; ++k) {
        add_triangle(j, k, 1);
        if (j + k + 2 <= m)
          add_triangle(j + 1, k + 1, -1);
      }
  }
}

AroundFront::AroundFront(const Solid& solid, const grid::Front& front) {
  const double h = solid.grid.h();
  std::array<std::array<double, cube::n_vertices>, cube::n_vertices> areas{};
  for (int i = 0; i < 27; ++i) {
    CellId c = front.cell;
    const std::array<int, 3> offset = {i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1};
    for (int axis = 0; axis < 3 && c.valid(); ++axis)
      if (offset[axis] != 0)
        c = solid.grid.neighbour(c, 2 * axis + (offset[axis] > 0));
    if (!c.valid())
      continue;
    const Vec3 middle = solid.grid.origin(c) + Vec3::Constant(0.5 * h);
    if (std::abs(front.normal.dot(middle - front.point)) > 0.5 * h * front.normal.lpNorm<1>())
      continue;
    const CellAtPlane at(solid, c, {front.point, front.normal}, rest_of(solid, c));
    if (!at.is_met())
      continue;
    OfVertices sums{};
    for (const Polygon& piece : at.material())
      add_integrals(solid, c, piece, sums);
    for (int w = 0; w < cube::n_vertices; ++w) {
      int v = 0; // of the front's cell, where that vertex is one of them
      bool is_shared = true;
      for (int axis = 0; axis < 3; ++axis) {
        const int place = offset[axis] + (w >> axis & 1);
        is_shared = is_shared && (place == 0 || place == 1);
        v |= (place & 1) << axis;
      }
      if (is_shared)
        areas[v][vertex_in(w)] += sums[w];
    }
  }
  for (int v = 0; v < cube::n_vertices; ++v) {
    for (const double area : areas[v])
      area_[v] += area;
    for (int octant = 0; octant < cube::n_vertices && area_[v] > 0; ++octant)
      shares_[v][octant] = static_cast<float>(areas[v][octant] / area_[v]);
  }
}

double AroundFront::part(const Solid& solid, const CellId own, const int v,
                         const FunctionRef<double(CellId, int)> come) const {
  double sum = 0;
  for (int octant = 0; octant < cube::n_vertices; ++octant)
    if (shares_[v][octant] > 0)
      sum += shares_[v][octant] * come(cell_around(solid.grid, own, v, octant), vertex_in(octant));
  return sum;
}

void AroundFront::for_each_cell(const Solid& solid, const CellId own, const int v,
                                const FunctionRef<void(CellId)> f) const {
  for (int octant = 0; octant < cube::n_vertices; ++octant)
    if (shares_[v][octant] > 0)
      f(cell_around(solid.grid, own, v, octant));
}

} // namespace kerf::cut
