#include "grid/cuts.h"

#include "grid/cube.h"

#include <algorithm>
#include <bit>
#include <stdexcept>

namespace kerf::grid {

Cuts::Cuts(const Grid& grid) : edge_cut_(grid.n_edges()), face_point_(grid.n_faces()), cell_point_(grid.n_cells()) {}

void Cuts::add(EdgeCut cut) {
  std::uint32_t& index = edge_cut_.at(cut.edge);
  if (index != none)
    throw std::logic_error("an edge is cut once");
  cut.t = std::clamp(cut.t, min_edge_parameter, 1 - min_edge_parameter);
  index = static_cast<std::uint32_t>(cuts_.size());
  cuts_.push_back(cut);
}

unsigned Cuts::configuration(const Grid& grid, const CellId c) const {
  const auto edges = grid.edges(c);
  unsigned lines = 0;
  for (int line = 0; line < cube::n_lines; ++line)
    if (is_cut(edges[line]))
      lines |= 1u << line;
  return lines;
}

std::size_t Cuts::n_bytes() const {
  return edge_cut_.n_bytes() + face_point_.n_bytes() + cell_point_.n_bytes() + cuts_.capacity() * sizeof(EdgeCut) +
         points_.capacity() * sizeof(Vec3);
}

void Cuts::set(std::uint32_t& index, const Vec3& p) {
  if (index == none) {
    index = static_cast<std::uint32_t>(points_.size());
    points_.push_back(p);
  } else
    points_[index] = p;
}

Vec3 edge_point(const Grid& grid, const Cuts& cuts, const EdgeId e) {
  Vec3 p = grid.position(grid.ends(e)[0]);
  const EdgeCut* cut = cuts.find(e);
  p[grid.axis(e)] += grid.h() * (cut ? cut->t : 0.5);
  return p;
}

Vec3 centre(const Grid& grid, const CellId c) { return grid.origin(c) + Vec3::Constant(0.5 * grid.h()); }

Vec3 centre(const Grid& grid, const FaceId f) {
  const auto& [below, above] = grid.cells(f);
  const CellId c = below.valid() ? below : above;
  const auto& faces = grid.faces(c);
  const int local = static_cast<int>(std::find(faces.begin(), faces.end(), f) - faces.begin());
  Vec3 p = centre(grid, c);
  p[cube::face_axis(local)] += (local & 1 ? 0.5 : -0.5) * grid.h();
  return p;
}

Vec3 face_point(const Grid& grid, const Cuts& cuts, const FaceId f) {
  const Vec3* p = cuts.point(f);
  return p ? *p : centre(grid, f);
}

Vec3 cell_point(const Grid& grid, const Cuts& cuts, const CellId c) {
  const Vec3* p = cuts.point(c);
  return p ? *p : centre(grid, c);
}

std::array<Tetrahedron, 6> octant(const Grid& grid, const Cuts& cuts, const CellId c, const int vertex) {
  const Vec3 origin = grid.origin(c);
  const auto edges = grid.edges(c);
  const auto faces = grid.faces(c);
  const auto local = [&](const Vec3& p) -> Vec3 { return (p - origin) / grid.h(); };
  const Vec3 node(vertex & 1, vertex >> 1 & 1, vertex >> 2 & 1);
  const Vec3 middle = local(cell_point(grid, cuts, c));
  std::array<Vec3, 3> on_edge, in_face;  // by the edge's direction, by the face's normal
  for (int axis = 0; axis < 3; ++axis) { // right on the edge and in the face: round-off may not turn a thin octant over
    on_edge[axis] = node;
    on_edge[axis][axis] = local(edge_point(grid, cuts, edges[cube::line_at(vertex, axis)]))[axis];
    in_face[axis] = local(face_point(grid, cuts, faces[cube::face_at(vertex, axis)]));
    in_face[axis][axis] = node[axis];
  }
  std::array<Tetrahedron, 6> tetrahedra;
  for (int i = 0; i < 6; ++i) {
    const int edge = i % 3, normal = (edge + (i < 3 ? 1 : 2)) % 3;
    Tetrahedron& t = tetrahedra[i];
    t = {node, on_edge[edge], in_face[normal], middle};
    const bool mirrored = (std::popcount(static_cast<unsigned>(vertex)) & 1) != 0;
    if (mirrored == (i >= 3))
      std::swap(t[1], t[2]);
  }
  return tetrahedra;
}

} // namespace kerf::grid
