#include "surface/border.h"

#include "surface/sight.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <bit>

namespace kerf::surface {

namespace {

namespace cube = grid::cube;
namespace skeleton = grid::skeleton;

constexpr std::size_t most_pieces = 2 * skeleton::n_segments;
using Pieces = Few<Plane, most_pieces>; // in the cut's plane: on it, and the direction from where it is seen, unit

Vec3 point_in_side(const grid::Solid& solid, const View& view, const int side) {
  if (side >= skeleton::first_triangle)
    return *solid.cuts.inner_point(view.cell, side - skeleton::first_triangle);
  const int face = side / 2;
  const grid::FaceId f = solid.grid.faces(view.cell)[face];
  const bool is_full = (view.now.material & cube::face_mask(face)) == cube::face_mask(face);
  return is_full ? grid::face_point(solid, f) : *solid.cuts.inner_point(f, side % 2);
}

/// Of the cuts of some segments. None where they do not lie in one plane with p.
Pieces pieces_of_border(const grid::Solid& solid, const View& view, const grid::Segments of, const Vec3& p,
                        const Vec3& normal) {
  constexpr double round_off = 1e-9; // of h
  const double h = solid.grid.h();
  const auto is_in_plane = [&](const Vec3& q) { return std::abs(normal.dot(q - p)) <= round_off * h; };
  Pieces pieces;
  bool is_flat = true;
  for_each_bit(of, [&](const int k) {
    const auto& [ends, sides] = view.now.skeleton().segment[k];
    const Vec3 at = grid::segment_point(solid, view.cell, view.now.skeleton(), k),
               along = grid::item_point(solid, view.cell, ends[1]) - grid::item_point(solid, view.cell, ends[0]);
    is_flat = is_flat && is_in_plane(at);
    for (const int way : {0, 1}) {
      const Vec3 beside = point_in_side(solid, view, sides[way]), piece = beside - at;
      is_flat = is_flat && is_in_plane(beside);
      const Vec3 inward = piece.cross(way == 0 ? normal : Vec3(-normal)) * (along.dot(normal) > 0 ? 1 : -1);
      if (piece.norm() > round_off * h)
        pieces.push_back({at, inward.normalized()});
    }
  });
  return is_flat ? pieces : Pieces();
}

/// In the middle of all points of the plane in the cell from where the pieces are seen; p where it is one of them.
std::optional<Vec3> point_that_sees(const View& view, const Pieces& pieces, const Vec3& p, const Vec3& normal,
                                    const double h) {
  constexpr double round_off = 1e-12, least = 1e-6; // of h
  const auto is_seen = [&](const Vec3& q, const double from) {
    return std::ranges::all_of(pieces, [&](const Plane& piece) { return height(q, piece) >= from * h; });
  };
  if (is_seen(p, -round_off))
    return p;
  const auto middle = middle_of({pieces.begin(), pieces.end()}, view.lower, view.upper, {{p, normal}});
  return middle && is_seen(*middle, least) ? middle : std::nullopt;
}

Vec3 normal_of(const grid::Solid& solid, const View& view) {
  return cut_plane(solid, view, std::countr_zero(view.now.blades)).plane.normal;
}

} // namespace

std::optional<Vec3> point_that_sees_border(const grid::Solid& solid, const View& view, const Vec3& p) {
  const Vec3 normal = normal_of(solid, view);
  return point_that_sees(view, pieces_of_border(solid, view, view.now.blades, p, normal), p, normal, solid.grid.h());
}

bool border_is_in_plane(const grid::Solid& solid, const View& view, const Vec3& p) {
  return !pieces_of_border(solid, view, view.now.blades, p, normal_of(solid, view)).empty();
}

grid::Segments border_of(const grid::Skeleton& skeleton, const grid::Segments cut, const int segment) {
  grid::Segments border = grid::Segments(1) << segment, before = 0;
  while (border != before) {
    before = border;
    grid::Sides sides = 0;
    for_each_bit(border, [&](const int k) {
      for (const int side : skeleton.segment[k].sides)
        sides |= grid::Sides(1) << side;
    });
    for_each_bit(cut & ~border, [&](const int k) {
      for (const int side : skeleton.segment[k].sides)
        if ((sides >> side & 1) != 0)
          border |= grid::Segments(1) << k;
    });
  }
  return border;
}

Vec3 vertex_of_border(const grid::Solid& solid, const grid::CellId cell, const grid::Segments border) {
  const View view = look_at(solid, cell);
  const Vec3 of_cell = *solid.cuts.inner_point(cell), normal = normal_of(solid, view);
  if (pieces_of_border(solid, view, view.now.blades, of_cell, normal).empty())
    return of_cell;
  Vec3 mean = Vec3::Zero();
  for_each_bit(border, [&](const int k) {
    mean += grid::segment_point(solid, cell, view.now.skeleton(), k) / std::popcount(border);
  });
  return point_that_sees(view, pieces_of_border(solid, view, border, mean, normal), mean, normal, solid.grid.h())
    .value_or(mean);
}

} // namespace kerf::surface
