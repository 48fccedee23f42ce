#include "grid/opening.h"

#include "grid/cube.h"

#include <Eigen/Geometry>

#include <array>

namespace kerf::grid {

namespace {

/// One side of a cut edge: where the copies there put the cut, and the deformation gradient, means over them.
struct Side {
  Vec3 position = Vec3::Zero();
  Mat3 gradient = Mat3::Zero();
  int n = 0;
};

/// Adds what the copy of `cell` knows whose material node is the edge's end at `vertex`.
void add(const Solid& solid, const CellId cell, const int vertex, const int axis, const double t, const Points& x,
         Side& side) {
  const auto& corners = solid.complex.copies[solid.complex.copy_at(cell, vertex)].corners;
  const auto at = [&](const int v) -> const Vec3& { return x[corners[v].value]; };
  const int lower = vertex & ~(1 << axis);
  side.position += (1 - t) * at(lower) + t * at(lower | 1 << axis);
  for (int k = 0; k < 3; ++k)
    side.gradient.col(k) += (at(vertex | 1 << k) - at(vertex & ~(1 << k))) / solid.grid.h();
  ++side.n;
}

} // namespace

std::vector<Gap> gaps(const Solid& solid, const CutLabel label, const Points& x) {
  std::vector<Gap> all;
  const double h = solid.grid.h();
  for (const EdgeCut& cut : solid.cuts.all()) {
    const auto& ends = solid.grid.ends(cut.edge);
    if (cut.label != label || !solid.grid.is_material(ends[0]) || !solid.grid.is_material(ends[1]))
      continue;
    const int axis = solid.grid.axis(cut.edge);
    std::array<Side, 2> sides;
    for (const CellId cell : solid.grid.cells(cut.edge))
      for (std::size_t end = 0; cell.valid() && end < 2; ++end)
        add(solid, cell, solid.grid.vertex(cell, ends[end]), axis, cut.t, x, sides[end]);
    const Mat3 F = 0.5 * (sides[0].gradient / sides[0].n + sides[1].gradient / sides[1].n);
    all.push_back({cut.edge, sides[1].position / sides[1].n - sides[0].position / sides[0].n,
                   h * h * F.col((axis + 1) % 3).cross(F.col((axis + 2) % 3))});
  }
  return all;
}

double opened_volume(const std::vector<Gap>& gaps) {
  double sum = 0;
  for (const Gap& gap : gaps)
    sum += gap.way.dot(gap.area);
  return sum;
}

} // namespace kerf::grid
