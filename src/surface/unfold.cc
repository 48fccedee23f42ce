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

constexpr double least = -1e-13; // of a cube: but for round-off

/// Has a part of the cell less than nothing, since some vertex does not see all around it? What cuts in one plane leave
/// is the same wherever in it their vertices lie, but not what a front parts.
bool is_folded(const grid::Solid& solid, const View& view) {
  const bool has_front = solid.cuts.front(view.cell) != nullptr;
  if (view.now.is_cut_at_skin()) {
    const Vec3* const p = solid.cuts.inner_point(view.cell);
    if (!p || all_is_seen(solid, view) || (!has_front && border_is_in_plane(solid, view, *p)))
      return false;
  } else if (!has_front || !grid::cuts_of_copies(solid, view.cell).is_cut_at_skin())
    return false;
  return !has_material(solid, view, least);
}

/// The cell's vertex; where a front alone parts the cell, none is placed, and it lies amid what the front's plane cuts.
Vec3 vertex_of(const grid::Solid& solid, const CellId c) {
  if (const Vec3* const p = solid.cuts.inner_point(c))
    return *p;
  constexpr grid::Items all = ~grid::Items(0);
  return solid.grid.origin(c) + solid.grid.h() * grid::pieces_of(solid, c, all).front().tetrahedron[3];
}

enum class Where { in_plane, anywhere };

/// Where a vertex may go: in these planes, from p.
struct Room {
  std::vector<Plane> in_planes;
  Vec3 p;
};

/// Of a vertex at p that can move along `directions`. In the plane of the cuts of some segments, where they have one,
/// it goes from where it is projected.
std::optional<Room> room(const grid::Solid& solid, const View& view, const Where where, const grid::Segments segments,
                         const Vec3& directions, const Vec3& p) {
  if (where == Where::anywhere)
    return Room{{}, p};
  Planes planes;
  for_each_bit(view.now.blades & segments,
               [&](const int segment) { planes.push_back(cut_plane(solid, view, segment).plane); });
  if (const grid::Front* const front = solid.cuts.front(view.cell); front && planes.empty())
    planes.push_back({front->point, front->normal});
  if (planes.empty() || !common_plane(planes, planes[0].point, in_plane * solid.grid.h()))
    return {};
  const Vec3 along = directions.cwiseProduct(planes[0].normal);
  if (along.norm() < in_plane)
    return {};
  return Room{{planes[0]}, p - height(p, planes[0]) / along.squaredNorm() * along};
}

/// Whether the vertex in a face has moved.
bool unfold_in_face(grid::Solid& solid, const View& view, const int side, const Where where) {
  const grid::FaceId f = solid.grid.faces(view.cell)[side / 2];
  const Vec3* const before = solid.cuts.inner_point(f, side % 2);
  if (before == nullptr || (!solid.cuts.front(view.cell) && cuts_are_in_plane(solid, view, side / 2, *before)))
    return false;
  const Vec3 in_face = Vec3::Ones() - Vec3::Unit(grid::cube::face_axis(side / 2));
  const auto within = room(solid, view, where, border(view.now.skeleton().side[side]), in_face, *before);
  const auto p = within ? seeing_border(solid, view, side, within->p, within->in_planes) : std::nullopt;
  if (!p || (*p - *before).norm() < in_plane * solid.grid.h()) // or two cells might move it by round-off for ever
    return false;
  solid.cuts.set_inner_point(f, side % 2, *p);
  return true;
}

void unfold_cell(grid::Solid& solid, const View& view, const Where where) {
  const auto within = room(solid, view, where, ~grid::Segments(0), Vec3::Ones(), vertex_of(solid, view.cell));
  if (!within)
    return;
  if (const auto p = seeing_skin(solid, view, within->p, within->in_planes))
    solid.cuts.set_inner_point(
      view.cell, nearest(within->p, *p, [&](const Vec3& at) { return has_material(solid, view, at, least); }));
}

} // namespace

std::size_t unfold(grid::Solid& solid, std::vector<CellId>& cells) {
  std::vector<CellId> left = cells, folded;
  while (!left.empty()) {
    const View view = look_at(solid, left.back());
    left.pop_back();
    for (const Where where : {Where::in_plane, Where::anywhere}) {
      if (!is_folded(solid, view))
        break;
      folded.push_back(view.cell);
      for (int side = 0; side < skeleton::first_triangle; ++side)
        if ((view.now.skeleton().sides >> side & 1) != 0 && unfold_in_face(solid, view, side, where))
          if (const CellId next = solid.grid.neighbour(view.cell, side / 2); next.valid()) {
            left.push_back(next);
            cells.push_back(next);
          }
      unfold_cell(solid, view, where);
    }
  }
  sort_unique(cells);
  sort_unique(folded);
  return std::ranges::count_if(folded, [&](const CellId c) { return is_folded(solid, look_at(solid, c)); });
}

} // namespace kerf::surface
