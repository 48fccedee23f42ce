#pragma once

/// The material of a cell's copies as tetrahedra.

#include "grid/solid.h"

namespace kerf::grid {

/// Vertices of a tetrahedron in coordinates of its cell, the unit cube [1].
using Tetrahedron = std::array<Vec3, 4>;

/// The octant of a cell: the material that belongs to `vertex`, as six positively oriented tetrahedra,
/// one for each way node - edge point - face point - centre. The eight octants of a cell tile it. Departs from the
/// trilinear hexahedron on the same eight points: tetrahedra have positive volume for every point inside its edge,
/// face and cell (a hexahedron folds where a cut leaves a face vertex in the chord of its edge vertices), and they
/// are bounded by just the triangles of the surface, so that volume by surface and mass by octants agree to round-
/// off.
std::array<Tetrahedron, 6> octant(const Solid& solid, CellId c, int vertex);

/// What lies between the blades' cuts and the skin at one line of the skin: a prism on each of the line's two faces,
/// from the triangle (edge point, face point, centre) of the cuts to that of the skin, in three tetrahedra each. Faces
/// and lines that share a side of a prism divide it by the same diagonal. Volumes are signed: positive where the skin
/// lies outside of the cuts. Empty where cuts and skin have all three points in common.
std::array<Tetrahedron, 6> under_skin(const Solid& solid, CellId c, int line);

/// A prism between two triangles, as three tetrahedra; the triangles' vertices correspond. Positive where the second
/// triangle lies on the side from which the first is seen counter-clockwise; the other way round with `mirrored`.
std::array<Tetrahedron, 3> prism(const std::array<Vec3, 3>& from, const std::array<Vec3, 3>& to, bool mirrored);

/// Calls f(tetrahedron, vertex) for all material of a copy: the octants of its nodes, and what lies under its part of
/// the skin; the vertex is the node's, or the material end of the skin's line.
template <class Function>
void for_each_tetrahedron(const Solid& solid, const Copy& copy, const Function& f);

/// Bits of the lines of the skin under which there may be material of the copy beside the octants.
unsigned lines_under_skin(const Solid& solid, const Copy& copy);

/// Volume of a tetrahedron with these vertices, positive where the last three turn counter-clockwise seen from outside
/// [1].
double volume(const Tetrahedron& t);
/// The material's part of a copy's cube; 1 where it holds all nodes [1].
double fill(const Solid& solid, const Copy& copy);

template <class Function>
void for_each_tetrahedron(const Solid& solid, const Copy& copy, const Function& f) {
  for (int vertex = 0; vertex < cube::n_vertices; ++vertex)
    if (copy.nodes >> vertex & 1)
      for (const Tetrahedron& t : octant(solid, copy.cell, vertex))
        f(t, vertex);
  const unsigned lines = lines_under_skin(solid, copy);
  for (int line = 0; line < cube::n_lines; ++line)
    if (lines >> line & 1) {
      const auto& [lower, upper] = cube::line_vertices[line];
      const int vertex = solid.grid.is_material(solid.grid.nodes(copy.cell)[lower]) ? lower : upper;
      for (const Tetrahedron& t : under_skin(solid, copy.cell, line))
        f(t, vertex);
    }
}

} // namespace kerf::grid
