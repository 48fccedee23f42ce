#pragma once

/// The material of a cell's copies as tetrahedra.

#include "grid/solid.h"

namespace kerf::grid {

/// Vertices of a tetrahedron in coordinates of its cell, the unit cube [1].
using Tetrahedron = std::array<Vec3, 4>;

/// The octant of a cell in which no blade has cut at the skin: the material that belongs to `vertex`, as six positively
/// oriented tetrahedra, one for each way node - edge point - face point - centre. The eight octants of a cell tile it.
/// Departs from the trilinear hexahedron on the same eight points: tetrahedra have positive volume for every point
/// inside its edge, face and cell (a hexahedron folds where a cut leaves a face vertex in the chord of its edge
/// vertices), and they are bounded by just the triangles of the surface, so that volume by surface and mass by octants
/// agree to round-off.
std::array<Tetrahedron, 6> octant(const Solid& solid, CellId c, int vertex);

/// A tetrahedron of a cell's material, and the vertex of the cube to which it belongs: the node's, or that below the
/// skin's point (Skeleton::vertex).
struct MaterialPiece {
  Tetrahedron tetrahedron;
  int vertex;
};

/// Where the vertices of cuts are taken to be: where they have been placed, or in the middle of the cuts around them,
/// which those alone tell.
enum class VerticesOfCuts { placed, amid_cuts };

/// The material of a part of a cell in which blades have cut at the skin: of each of its items, for each segment from
/// there and each side at that the tetrahedron item - cut - vertex in the side - vertex in the cell. Together they fill
/// what the part's surface bounds, and so the parts the cell as it was. Volumes are signed: where the cell's vertex does
/// not see a side from within (surface/sight.h), some are negative; their sum is so for the skin of a dent alone, which is
/// one with the part around it (cut/dents.h).
std::vector<MaterialPiece> pieces_of(const Solid& solid, CellId c, Items items,
                                     VerticesOfCuts vertices = VerticesOfCuts::placed);
/// Its vertex in the cell, and in a side, where they are placed; else amid the cuts and what a front's plane meets [m].
Vec3 vertex_of_cuts(const Solid& solid, CellId c);
Vec3 vertex_of_cuts(const Solid& solid, CellId c, int side);

/// Calls f(tetrahedron, vertex) for all material of a copy.
template <class Function>
void for_each_tetrahedron(const Solid& solid, const Copy& copy, const Function& f);

/// Volume of a tetrahedron with these vertices, positive where the last three turn counter-clockwise seen from outside
/// [1].
double volume(const Tetrahedron& t);
/// Integrals of N_0 .. N_7 over a tetrahedron in the unit cube [1].
std::array<double, 8> shape_integrals(const Tetrahedron& t);
/// Adds integrals of N_a N_b, a, b = 0 .. 7, over a tetrahedron in the unit cube [1]; below the diagonal alone.
void add_shape_products(const Tetrahedron& t, Eigen::Matrix<double, 8, 8>& products);
/// The material's part of a copy's cube; 1 where it holds all nodes [1].
double fill(const Solid& solid, const Copy& copy);

template <class Function>
void for_each_tetrahedron(const Solid& solid, const Copy& copy, const Function& f) {
  if (copy.skin != 0 || (copy.nodes != 0xff && cuts_of_copies(solid, copy.cell).is_cut_at_skin())) {
    for (const auto& [t, vertex] : pieces_of(solid, copy.cell, copy.items()))
      f(t, vertex);
    return;
  }
  for (int vertex = 0; vertex < cube::n_vertices; ++vertex)
    if (copy.nodes >> vertex & 1)
      for (const Tetrahedron& t : octant(solid, copy.cell, vertex))
        f(t, vertex);
}

} // namespace kerf::grid
