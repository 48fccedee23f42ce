#include "cut/part_face.h"

#include "grid/parts.h"

namespace kerf::cut {

void part_face(const grid::Grid& grid, grid::Cuts& cuts, const grid::CellId c, const int face,
               std::vector<grid::EdgeId>& edges) {
  cuts.set_seam(grid.faces(c)[face], grid::Seam::parted);
  const unsigned blades = grid::cuts_of(grid, cuts, c).blades();
  const auto of_cell = grid.edges(c);
  for (const int line : grid::cube::face_lines[face])
    if (blades >> line & 1)
      edges.push_back(of_cell[line]);
}

} // namespace kerf::cut
