#pragma once

/// Cells whose material a sweep passed through without cutting any of their segments: what the grid cannot resolve of
/// it.
///
/// Definition: a triangle of the strip meets one of the tetrahedra of the cell's octants (grid/cuts.h), its vertices
/// moved by the trilinear map of their copy, each shrunk towards its middle by 1e-6, so that a strip right in a face or
/// through an edge passes through neither side; and no segment of the cell (grid/skeleton.h) is cut by the same label.
/// A cell is counted once, and no longer when one of them is cut by that label later: what a front crosses in several
/// steps ends with nothing.
///
/// The strip is met as the blade moves relative to the copy: what the blade swept a while before the end of the step
/// goes on with the copy's middle until then. Limits: what material does that moves through a resting blade is not seen,
/// nor how a copy turns and stretches during a step. Where the map folds a cell over, its tetrahedra still count. A cell
/// whose corners lie further from the edges of its block (edge_boxes.h) than twice the longest of them can be missed.

#include "cut/edge_boxes.h"
#include "cut/recut.h"

#include <set>
#include <span>

namespace kerf::cut {

/// A triangle that a blade sweeps in a step.
struct SweptTriangle {
  std::array<Vec3, 3> vertices;     ///< [m], world frame
  std::array<double, 3> left = {0}; ///< how much of the step was left when the blade was there [1]
};
std::vector<SweptTriangle> swept_triangles(const BladePath& path);

class PassedCells {
 public:
  /// Adds what `strip` passes in a body whose corners have moved from `x_before` to `x` [m], to which `boxes` are
  /// fitted. Cells with a segment that is cut with this label, or is among `found`, are left out.
  void pass(std::span<const SweptTriangle> strip, const SweepCuts& found, const grid::Solid& solid,
            const Points& x_before, const Points& x, const EdgeBoxes& boxes, grid::CutLabel label);

  /// Takes out cells in which the same label has cut now; invalid ones are passed over.
  void remove(std::span<const grid::CellId> cells);

  const std::set<grid::CellId>& cells() const { return cells_; }
  void archive(Archive& a) { a(cells_); }

 private:
  std::set<grid::CellId> cells_;
};

} // namespace kerf::cut
