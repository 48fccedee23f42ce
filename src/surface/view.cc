#include "surface/view.h"

#include <algorithm>
#include <cmath>

namespace kerf::surface {

namespace cube = grid::cube;

grid::CellCuts View::before() const {
  grid::CellCuts result = now;
  result.twice &= old;
  result.cut &= old | result.skin;
  for (int face = 0; face < cube::n_faces; ++face)
    if ((now.blades() & ~old & cube::lines_of_face[face]) != 0 || (parted_faces >> face & 1) != 0)
      result.seams[face] = grid::Seam::whole; // what parts it now is new
  return result;
}

grid::CellCuts View::without_blades() const {
  grid::CellCuts result = now;
  result.cut = result.skin;
  result.twice = 0;
  return result;
}

Plane View::mean_plane(const unsigned lines) const {
  const unsigned fresh = lines & ~old, used = fresh != 0 ? fresh : lines;
  Planes of_cuts;
  Vec3 sum = Vec3::Zero();
  for_each_bit(used, [&](const int line) {
    of_cuts.push_back(planes[line]);
    sum += std::copysign(1.0, sum.dot(planes[line].normal)) * planes[line].normal;
  });
  return {mean_point(of_cuts), sum.normalized()};
}

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
  const auto faces = solid.grid.faces(c);
  for (int face = 0; face < cube::n_faces; ++face)
    view.parted_faces |= unsigned(solid.cuts.is_newly_parted(faces[face]) && view.now.has_two_points(face)) << face;
  for_each_bit(view.now.twice,
               [&](const int line) { view.skin_planes[line] = plane_of(line, *solid.cuts.find_outer(edges[line])); });
  return view;
}

} // namespace kerf::surface
