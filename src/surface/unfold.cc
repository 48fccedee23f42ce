#include "surface/unfold.h"

#include "base/sort_unique.h"
#include "surface/border.h"
#include "surface/sight.h"

namespace kerf::surface {

namespace {

namespace skeleton = grid::skeleton;
using grid::CellId;

/// Has a part of the cell less than nothing, since some vertex does not see all around it? What cuts in one plane leave
/// is the same wherever in it their vertices lie, but not what a front parts.
bool is_folded(grid::Solid& solid, const View& view) {
  constexpr double least = -1e-13; // but for round-off, of a cube
  if (!view.now.is_cut_at_skin() || solid.cuts.inner_point(view.cell) == nullptr || all_is_seen(solid, view))
    return false;
  const Vec3 p = *solid.cuts.inner_point(view.cell);
  return (solid.cuts.front(view.cell) != nullptr || !border_is_in_plane(solid, view, p)) &&
         !has_material(solid, view, p, least);
}

/// Whether the vertex in a face has moved.
bool unfold_in_face(grid::Solid& solid, const View& view, const int side) {
  const grid::FaceId f = solid.grid.faces(view.cell)[side / 2];
  const Vec3* const before = solid.cuts.inner_point(f, side % 2);
  if (before == nullptr || (!solid.cuts.front(view.cell) && cuts_are_in_plane(solid, view, side / 2, *before)))
    return false;
  const auto p = seeing_border(solid, view, side, *before, {});
  if (!p || (*p - *before).norm() < in_plane * solid.grid.h()) // or two cells might move it by round-off for ever
    return false;
  solid.cuts.set_inner_point(f, side % 2, *p);
  return true;
}

} // namespace

void unfold(grid::Solid& solid, std::vector<CellId>& cells) {
  std::vector<CellId> left = cells;
  while (!left.empty()) {
    const View view = look_at(solid, left.back());
    left.pop_back();
    if (!is_folded(solid, view))
      continue;
    for (int side = 0; side < skeleton::first_triangle; ++side)
      if ((view.now.skeleton().sides >> side & 1) != 0 && unfold_in_face(solid, view, side))
        if (const CellId next = solid.grid.neighbour(view.cell, side / 2); next.valid()) {
          left.push_back(next);
          cells.push_back(next);
        }
    if (const auto p = seeing_skin(solid, view, *solid.cuts.inner_point(view.cell), {}))
      solid.cuts.set_inner_point(view.cell, *p);
  }
  sort_unique(cells);
}

} // namespace kerf::surface
