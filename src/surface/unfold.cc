#include "surface/unfold.h"

#include "base/sort_unique.h"
#include "grid/material.h"
#include "surface/border.h"
#include "surface/sight.h"

#include <algorithm>
#include <optional>

namespace kerf::surface {

namespace {

namespace skeleton = grid::skeleton;
using grid::CellId;

/// Has a part of the cell less than nothing, since some vertex does not see all around it? What cuts in one plane leave
/// is the same wherever in it their vertices lie, but not what a front parts.
bool is_folded(const grid::Solid& solid, const View& view) {
  const bool has_front = solid.cuts.front(view.cell) != nullptr;
  if (view.now.is_cut_at_skin()) {
    const Vec3* const p = solid.cuts.inner_point(view.cell);
    if (!p || (!has_front && (all_is_seen(solid, view) || border_is_in_plane(solid, view, *p))))
      return false;
  } else if (!has_front || !grid::cuts_of_copies(solid, view.cell).is_cut_at_skin())
    return false;
  return !has_material(solid, view, nothing);
}

enum class Where { in_plane, anywhere };

/// Where a vertex may go: in these planes, from p.
struct Reach {
  std::vector<Plane> in_planes;
  Vec3 p;
};

/// Of a vertex at p that can move along `directions`. In the plane of the cuts of some segments, where they have one,
/// it goes from where it is projected, or from the middle of what of that lies in the cell.
std::optional<Reach> reach(const grid::Solid& solid, const View& view, const Where where, const grid::Segments segments,
                           const Vec3& directions, const Vec3& p) {
  if (where == Where::anywhere)
    return Reach{{}, p};
  Planes planes;
  for_each_bit(view.now.blades & segments,
               [&](const int segment) { planes.push_back(cut_plane(solid, view, segment).plane); });
  if (const grid::Front* const front = solid.cuts.front(view.cell); front && planes.empty())
    planes.push_back({front->point, front->normal});
  if (planes.empty() || !common_plane(planes, planes[0].point, in_plane * solid.grid.h()))
    return {};
  const Vec3 along = directions.cwiseProduct(planes[0].normal);
  if (along.norm() < least_lean)
    return {};
  const Vec3 foot = p - height(p, planes[0]) / along.squaredNorm() * along;
  if (directions != Vec3::Ones() || view.inside(foot) == foot) // what sees a face's border lies in the face
    return Reach{{planes[0]}, foot};
  const auto middle = middle_of({}, view.lower, view.upper, {planes[0]});
  return middle ? std::optional<Reach>({{planes[0]}, *middle}) : std::nullopt;
}

/// Whether the vertex in a face has moved.
bool unfold_in_face(grid::Solid& solid, const View& view, const int side, const Where where) {
  const grid::FaceId f = solid.grid.faces(view.cell)[side / 2];
  const bool is_full = (view.now.skeleton().items >> skeleton::on_arc(side / 2, 0) & 1) == 0;
  const bool has_front = solid.cuts.front(view.cell) != nullptr;
  const Vec3* const placed = solid.cuts.inner_point(f, side % 2);
  if (is_full || (placed == nullptr && !has_front))
    return false;
  const Vec3 before = placed ? *placed : grid::vertex_of_cuts(solid, view.cell, side);
  if (!has_front && cuts_are_in_plane(solid, view, side / 2, before))
    return false;
  const Vec3 in_face = Vec3::Ones() - Vec3::Unit(grid::cube::face_axis(side / 2));
  const auto within = reach(solid, view, where, border(view.now.skeleton().side[side]), in_face, before);
  const auto p = within ? seeing_border(solid, view, side, within->p, within->in_planes) : std::nullopt;
  if (!p || (*p - before).norm() < in_plane * solid.grid.h()) // or two cells might move it by round-off for ever
    return false;
  solid.cuts.set_inner_point(f, side % 2, *p);
  return true;
}

/// From where the cell's vertex was `before`.
void unfold_cell(grid::Solid& solid, const View& view, const Where where, const Vec3& before) {
  const auto within = reach(solid, view, where, ~grid::Segments(0), Vec3::Ones(), before);
  if (!within)
    return;
  if (const auto p = seeing_skin(solid, view, within->p, within->in_planes))
    solid.cuts.set_inner_point(
      view.cell, nearest(within->p, *p, [&](const Vec3& at) { return has_material(solid, view, at, nothing); }));
}

} // namespace

std::size_t unfold(grid::Solid& solid, std::vector<CellId>& cells) {
  std::vector<CellId> left = cells, folded;
  while (!left.empty()) {
    const View view = look_at(solid, left.back());
    left.pop_back();
    if (!is_folded(solid, view))
      continue;
    folded.push_back(view.cell);
    const Vec3 before = grid::vertex_of_cuts(solid, view.cell);
    for (const Where where : {Where::in_plane, Where::anywhere}) {
      if (!is_folded(solid, view))
        break;
      for (int side = 0; side < skeleton::first_triangle; ++side)
        if ((view.now.skeleton().sides >> side & 1) != 0 && unfold_in_face(solid, view, side, where))
          if (const CellId next = solid.grid.neighbour(view.cell, side / 2); next.valid()) {
            left.push_back(next);
            cells.push_back(next);
          }
      unfold_cell(solid, view, where, before);
    }
  }
  sort_unique(cells);
  sort_unique(folded);
  return std::ranges::count_if(folded, [&](const CellId c) { return is_folded(solid, look_at(solid, c)); });
}

} // namespace kerf::surface
