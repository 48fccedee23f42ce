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
/// Limits: the strip is that of the blade in space, against the body as it stands after the step; what material does
/// that moves through a resting blade is not seen. Where the map folds a cell over, its tetrahedra still count. A cell
/// whose corners lie further from the edges of its block (edge_boxes.h) than twice the longest of them can be missed.

#include "cut/edge_boxes.h"
#include "cut/recut.h"

#include <set>
#include <span>

namespace kerf::cut {

class PassedCells {
 public:
  /// Adds what `strip` (triangles [m], world frame) passes in a body with its corners at `x` [m], to which `boxes` are
  /// fitted. Cells with a segment that is cut with this label, or is among `found`, are left out.
  void pass(std::span<const std::array<Vec3, 3>> strip, const SweepCuts& found, const grid::Solid& solid,
            const Points& x, const EdgeBoxes& boxes, grid::CutLabel label);

  /// Takes out cells in which the same label has cut now; invalid ones are passed over.
  void remove(std::span<const grid::CellId> cells);

  const std::set<grid::CellId>& cells() const { return cells_; }
  void archive(Archive& a) { a(cells_); }

 private:
  std::set<grid::CellId> cells_;
};

} // namespace kerf::cut
