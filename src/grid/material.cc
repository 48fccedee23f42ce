#include "grid/material.h"

#include "grid/cube.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <bit>

namespace kerf::grid {

std::array<Tetrahedron, 6> octant(const Solid& solid, const CellId c, const int vertex) {
  const Vec3 origin = solid.grid.origin(c);
  const auto edges = solid.grid.edges(c);
  const auto faces = solid.grid.faces(c);
  const auto local = [&](const Vec3& p) -> Vec3 { return (p - origin) / solid.grid.h(); };
  const Vec3 node(vertex & 1, vertex >> 1 & 1, vertex >> 2 & 1);
  const Vec3 middle = local(cell_point(solid, c));
  std::array<Vec3, 3> on_edge, in_face;  // by the edge's direction, by the face's normal
  for (int axis = 0; axis < 3; ++axis) { // right on the edge and in the face: round-off may not turn a thin octant over
    on_edge[axis] = node;
    on_edge[axis][axis] = local(edge_point(solid, edges[cube::line_at(vertex, axis)]))[axis];
    in_face[axis] = local(face_point(solid, faces[cube::face_at(vertex, axis)]));
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

std::array<Tetrahedron, 3> prism(const std::array<Vec3, 3>& from, const std::array<Vec3, 3>& to, const bool mirrored) {
  std::array<Tetrahedron, 3> tetrahedra = {Tetrahedron{from[0], from[1], from[2], to[2]},
                                           Tetrahedron{from[0], from[1], to[2], to[1]},
                                           Tetrahedron{from[0], to[1], to[2], to[0]}};
  if (mirrored)
    for (Tetrahedron& t : tetrahedra)
      std::swap(t[1], t[2]);
  return tetrahedra;
}

std::array<Tetrahedron, 6> under_skin(const Solid& solid, const CellId c, const int line) {
  const Vec3 origin = solid.grid.origin(c);
  const auto faces = solid.grid.faces(c);
  const EdgeId edge = solid.grid.edges(c)[line];
  const auto local = [&](const Vec3& p) -> Vec3 { return (p - origin) / solid.grid.h(); };
  const int axis = cube::line_axis(line), lower = cube::line_vertices[line][0];
  const int vertex = solid.grid.is_material(solid.grid.ends(edge)[0]) ? lower : cube::line_vertices[line][1];
  Vec3 of_cut(lower & 1, lower >> 1 & 1, lower >> 2 & 1), of_skin = of_cut;
  of_cut[axis] = local(edge_point(solid, edge))[axis];
  of_skin[axis] = local(edge_skin_point(solid, edge))[axis];
  const Vec3 middle = local(cell_point(solid, c)), skin_middle = local(cell_skin_point(solid, c, line));
  std::array<Tetrahedron, 6> tetrahedra;
  for (int i = 0; i < 2; ++i) {
    const int normal = (axis + 1 + i) % 3;
    const int face = cube::face_at(vertex, normal);
    Vec3 in_face = local(face_point(solid, faces[face])),
         skin_in_face = local(face_skin_point(solid, faces[face], cube::place_in_face(face, line)));
    in_face[normal] = skin_in_face[normal] = of_cut[normal];
    const bool turned = (std::popcount(static_cast<unsigned>(vertex)) & 1) != 0; // as in octant()
    const auto of_face = prism({of_cut, in_face, middle}, {of_skin, skin_in_face, skin_middle}, turned == (i == 1));
    std::copy(of_face.begin(), of_face.end(), tetrahedra.begin() + 3 * i);
  }
  return tetrahedra;
}

double volume(const Tetrahedron& t) { return (t[1] - t[0]).dot((t[2] - t[0]).cross(t[3] - t[0])) / 6; }

double fill(const Solid& solid, const Copy& copy) {
  if (copy.nodes == 0xff)
    return 1;
  double sum = 0;
  for_each_tetrahedron(solid, copy, [&](const Tetrahedron& t, int) { sum += volume(t); });
  return sum;
}

unsigned lines_under_skin(const Solid& solid, const Copy& copy) {
  const CellCuts cell = cuts_of(solid, copy.cell);
  if (!cell.has_two_points())
    return 0;
  unsigned lines = copy.rinds;
  for (int line = 0; line < cube::n_lines; ++line)
    if (const auto& [v, w] = cube::line_vertices[line];
        ((cell.skin & ~cell.twice) >> line & 1) != 0 && ((copy.nodes >> v | copy.nodes >> w) & 1) != 0)
      lines |= 1u << line;
  return lines;
}

} // namespace kerf::grid
