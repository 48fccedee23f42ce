#pragma once

/// Nodes come first: what blades have parted edge by edge, the skin above does not hold together (grid/parts.h). Where
/// cuts cross below the skin, or a blade passes between the edges of the grid, it would.

#include "grid/solid.h"

#include <vector>

namespace kerf::cut {

/// Does the skin of a cell beside blades' cuts hold nodes together that no edges of the cell join, and that lie on two
/// sides of a plane along which a blade has cut in it?
bool must_be_parted(const grid::Solid& solid, grid::CellId c);

/// Parts the skin of the cell's faces that do: first where a cut may still go on, then between rinds, then anywhere, no
/// more than needed. Returns cut edges at those faces.
std::vector<grid::EdgeId> keep_nodes_apart(grid::Solid& solid, grid::CellId c);

} // namespace kerf::cut
