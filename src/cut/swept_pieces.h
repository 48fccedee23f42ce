#pragma once

/// What a blade sweeps, piece by piece in the cells that it comes into, where these are at rest.

#include "cut/cell_at_plane.h"
#include "cut/edge_boxes.h"
#include "cut/near_sweep.h"
#include "grid/solid.h"

namespace kerf::cut {

/// A cell's cube at rest, and so much around it [m].
Box around(const grid::Solid& solid, grid::CellId c, double more);

/// What of a convex polygon lies in a box.
Polygon clipped(Polygon polygon, const Box& box);

class SweptPieces {
 public:
  /// While the corners go from x_before to x [m]; `lag`: the most of fronts [cubes].
  SweptPieces(const BladePath& path, const grid::Solid& solid, const Points& x_before, const Points& x, double lag);
  /// What a mesh cuts at once, with the corners at x.
  SweptPieces(const geometry::TriangleMesh& mesh, const grid::Solid& solid, const Points& x, double lag);

  bool is_near(const EdgeBoxes::Block& block) const { return near_.may_be_in(block.around_cells()); }
  bool is_near(const grid::CellId c) const { return near_.may_be_in(box_of(c)); }

  /// Convex polygons at rest [m], of what lies in the cell and where a front in another cell may reach over by its lag.
  std::vector<Polygon> in(grid::CellId c) const;

 private:
  Box box_of(grid::CellId c) const;

  const grid::Solid& solid_;
  const Points &x_before_, &x_;
  std::vector<Patch> patches_;
  std::vector<std::array<double, 2>> fractions_; // of the way from x_before to x, at which the first and the last two
                                                 // points of a patch stand
  NearSweep near_;
  double lag_;
};

} // namespace kerf::cut
