#include "surface/view.h"

namespace kerf::surface {

namespace cube = grid::cube;

Vec3 View::inside(const Vec3& p) const {
  const Vec3 margin = grid::min_edge_parameter * (upper - lower);
  return p.cwiseMax(lower + margin).cwiseMin(upper - margin);
}

View look_at(const grid::Solid& solid, const grid::CellId c) {
  View view;
  view.cell = c;
  const auto edges = solid.grid.edges(c);
  Index3 index = solid.grid.index(solid.grid.nodes(c)[0]);
  view.lower = solid.grid.lattice().position(index);
  for (int& i : index)
    ++i;
  view.upper = solid.grid.lattice().position(index);
  const auto plane_of = [&](const int line, const grid::EdgeCut& cut) -> Plane {
    const int v = cube::line_vertices[line][0];
    Vec3 p(v & 1 ? view.upper[0] : view.lower[0], v & 2 ? view.upper[1] : view.lower[1],
           v & 4 ? view.upper[2] : view.lower[2]);
    p[cube::line_axis(line)] += solid.grid.h() * cut.t;
    return {p, cut.normal};
  };
  unsigned cut_lines = 0;
  for (int line = 0; line < cube::n_lines; ++line)
    if (const grid::EdgeCut* cut = solid.cuts.find(edges[line])) {
      cut_lines |= 1u << line;
      view.old |= unsigned(!solid.cuts.is_new(edges[line])) << line;
      view.planes[line] = plane_of(line, *cut);
      view.labels[line] = cut->label;
    }
  view.now = grid::cuts_of(solid, c, cut_lines);
  for_each_bit(view.now.blades, [&](const int segment) {
    const bool is_old = segment < grid::skeleton::first_half
                          ? (view.old >> segment & 1) != 0
                          : !solid.cuts.is_new(grid::skin_segment(solid.grid, c, segment));
    view.old_blades |= grid::Segments(is_old) << segment;
  });
  return view;
}

CutPlane cut_plane(const grid::Solid& solid, const View& view, const int segment) {
  if (segment < grid::skeleton::first_half)
    return {view.planes[segment], view.labels[segment]};
  const grid::SkinCut& cut = *solid.cuts.find(grid::skin_segment(solid.grid, view.cell, segment));
  return {{grid::segment_point(solid, view.cell, view.now.skeleton(), segment), cut.normal}, cut.label};
}

bool cuts_are_in_plane(const grid::Solid& solid, const View& view, const Vec3& p) {
  Planes planes;
  for_each_bit(view.now.blades,
               [&](const int segment) { planes.push_back(cut_plane(solid, view, segment).plane); });
  return common_plane(planes, p, in_plane * solid.grid.h()).has_value();
}

bool cuts_are_in_plane(const grid::Solid& solid, const View& view, const int face, const Vec3& p) {
  const grid::CellId next = solid.grid.neighbour(view.cell, face);
  return cuts_are_in_plane(solid, view, p) && (!next.valid() || cuts_are_in_plane(solid, look_at(solid, next), p));
}

grid::Segments border(const grid::Skeleton::Side& side) {
  grid::Segments segments = 0;
  for (int i = 0; i < side.n; ++i)
    segments |= grid::Segments(1) << side.segments[i];
  return segments;
}

Vec3 middle_of(const grid::Solid& solid, const View& view, const int side) {
  const grid::Skeleton::Side& of = view.now.skeleton().side[side];
  Vec3 sum = Vec3::Zero();
  for (int i = 0; i < of.n; ++i)
    sum += grid::item_point(solid, view.cell, of.items[i]);
  return sum / of.n;
}

Vec3 mean_point_of(const grid::Solid& solid, const View& view, const grid::Segments of) {
  Vec3 sum = Vec3::Zero();
  for_each_bit(view.now.blades & of, [&](const int segment) {
    sum += grid::segment_point(solid, view.cell, view.now.skeleton(), segment);
  });
  return sum / std::popcount(view.now.blades & of);
}

} // namespace kerf::surface
