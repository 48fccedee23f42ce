#include "grid/complex.h"

#include "base/union_find.h"
#include "grid/cube.h"

#include <bit>

namespace kerf::grid {

namespace {

std::uint8_t material_bits(const Grid& grid, const CellId c) {
  unsigned bits = 0;
  for (int v = 0; v < 8; ++v)
    bits |= unsigned(grid.is_material(grid.nodes(c)[v])) << v;
  return static_cast<std::uint8_t>(bits);
}

void make_copies(const Grid& grid, const Cuts& cuts, CellComplex& complex) {
  complex.first_copy.reserve(grid.n_cells() + 1);
  complex.copies.reserve(grid.n_cells());
  for (const CellId c : ids<CellId>(grid.n_cells())) {
    complex.first_copy.push_back(static_cast<std::uint32_t>(complex.copies.size()));
    const unsigned cut_lines = cuts.configuration(grid, c);
    unsigned left = material_bits(grid, c);
    while (left != 0) {
      const std::uint8_t component = cube::reachable(std::countr_zero(left), cut_lines);
      complex.copies.push_back({c, component, {}});
      left &= ~unsigned(component);
    }
  }
  complex.first_copy.push_back(static_cast<std::uint32_t>(complex.copies.size()));
}

/// Calls glue(copy, vertex, copy, vertex) for the four vertices of each face along which two copies are glued.
template <class Glue>
void for_each_glued_face(const Grid& grid, const CellComplex& complex, const Glue& glue) {
  for (const CellId below : ids<CellId>(grid.n_cells()))
    for (int axis = 0; axis < 3; ++axis) {
      const CellId above = grid.cells(grid.faces(below)[2 * axis + 1])[1];
      if (!above.valid())
        continue;
      for (auto a = complex.first_copy[below]; a < complex.first_copy[CellId(below.value + 1)]; ++a)
        for (auto b = complex.first_copy[above]; b < complex.first_copy[CellId(above.value + 1)]; ++b) {
          const unsigned upper = complex.copies[CopyId(a)].nodes & cube::face_mask(2 * axis + 1);
          const unsigned lower = complex.copies[CopyId(b)].nodes & cube::face_mask(2 * axis);
          if ((upper >> (1 << axis) & lower) != 0)
            for (const int v : cube::face_vertices[2 * axis])
              glue(a, v | 1 << axis, b, v);
        }
    }
}

} // namespace

CopyId CellComplex::copy_at(const CellId cell, const int vertex) const {
  for (auto c = first_copy[cell]; c < first_copy[CellId(cell.value + 1)]; ++c)
    if (copies[CopyId(c)].nodes >> vertex & 1)
      return CopyId(c);
  return {};
}

CellComplex build_complex(const Grid& grid, const Cuts& cuts) {
  CellComplex complex;
  make_copies(grid, cuts, complex);

  UnionFind corners(8 * complex.n_copies()), pieces(complex.n_copies());
  for_each_glued_face(grid, complex, [&](const std::uint32_t a, const int va, const std::uint32_t b, const int vb) {
    corners.unite(8 * a + va, 8 * b + vb);
    pieces.unite(a, b);
  });

  std::vector<std::uint32_t> corner_of;
  complex.node.resize(corners.number(corner_of));
  complex.n_pieces = pieces.number(complex.piece.items());
  complex.real_corner.resize(grid.n_nodes());
  for (const CopyId c : ids<CopyId>(complex.n_copies())) {
    Copy& copy = complex.copies[c];
    for (int v = 0; v < 8; ++v) {
      const CornerId corner(corner_of[8 * c.value + v]);
      const NodeId node = grid.nodes(copy.cell)[v];
      copy.corners[v] = corner;
      complex.node[corner] = node;
      if (copy.nodes >> v & 1)
        complex.real_corner[node] = corner;
    }
  }
  return complex;
}

Table<CornerId, CornerId> parents(const CellComplex& before, const CellComplex& after) {
  Table<CornerId, CornerId> parent(after.n_corners());
  for (const Copy& copy : after.copies) {
    const Copy& from = before.copies[before.copy_at(copy.cell, std::countr_zero(copy.nodes))];
    for (int v = 0; v < 8; ++v)
      parent[copy.corners[v]] = from.corners[v];
  }
  return parent;
}

Points rest_positions(const Grid& grid, const CellComplex& complex) {
  Points x;
  x.reserve(complex.n_corners());
  for (const NodeId n : complex.node)
    x.push_back(grid.position(n));
  return x;
}

} // namespace kerf::grid
