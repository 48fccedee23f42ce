#pragma once

/// Where the vertices that cuts have in faces and cells are drawn: where grid::Cuts has them, but for those at which the
/// surface closes in a cell with a front (grid::Front), or in a face beside one. These lie where that ends, as far as
/// cuts of edges lead into the cell: of a cell that the front has come into, but not to an edge, nothing is drawn.
/// Material and elements know nothing of it: both sides of the cut share such a vertex, so it encloses no volume.

#include "grid/skeleton.h"
#include "grid/solid.h"

namespace kerf::surface {

/// `closes`: the cuts in it part nothing there.
Vec3 vertex_in_face(const grid::Solid& solid, grid::CellId c, int face, bool closes);
Vec3 vertex_in_cell(const grid::Solid& solid, grid::CellId c, bool closes);

/// A cell in which blades have cut at the skin.
struct CutAtSkin {
  const grid::Solid& solid;
  grid::CellId cell;
  const grid::Skeleton& skeleton;
  grid::Segments blades;

  bool is_cut(const int segment) const { return (blades >> segment & 1) != 0; }
  Vec3 point(const int segment) const { return grid::segment_point(solid, cell, skeleton, segment); }
  /// Does one cut alone lead into the side?
  bool closes_in(int side) const;
  int cut_of(int side) const; ///< the first segment that is
};
/// In a face, beside an arc of the skin.
Vec3 vertex_in_polygon(const CutAtSkin& at, int side);
/// In a triangle of the skin.
Vec3 vertex_in_skin(const CutAtSkin& at, int triangle);
/// In the cell, of all its cuts.
Vec3 vertex_below_skin(const CutAtSkin& at);

} // namespace kerf::surface
