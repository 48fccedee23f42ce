#include "cut/part_face.h"

#include "grid/parts.h"

namespace kerf::cut {

void part_face(grid::Solid& solid, const grid::CellId c, const int face, std::vector<grid::EdgeId>& edges) {
  solid.cuts.set_seam(solid.grid.faces(c)[face], grid::Seam::parted);
  const unsigned blades = grid::cuts_of(solid, c).blades();
  const auto of_cell = solid.grid.edges(c);
  for (const int line : grid::cube::face_lines[face])
    if (blades >> line & 1)
      edges.push_back(of_cell[line]);
}

} // namespace kerf::cut
