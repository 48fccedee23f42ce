#pragma once

/// Parts the skin of a face.

#include "grid/solid.h"

#include <vector>

namespace kerf::cut {

/// Parts the skin of a cell's face, and adds the edges of the face that blades have cut; around others there may be
/// cells of the skin that no blade has cut: they stay as they are.
void part_face(grid::Solid& solid, grid::CellId c, int face, std::vector<grid::EdgeId>& edges);

} // namespace kerf::cut
