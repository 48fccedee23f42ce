#pragma once

/// Nodes come first: what blades have parted edge by edge, the skin above does not hold together (grid/parts.h). Where
/// cuts cross below the skin, or a blade passes between the edges of the grid, it would.

#include "grid/cuts.h"

#include <span>
#include <vector>

namespace kerf::cut {

/// In the cells around these edges, parts the skin of faces that joins nodes of the cell which no edges of the cell
/// join: first where a cut may still go on, then between rinds, then anywhere. Returns cut edges at those faces.
std::vector<grid::EdgeId> keep_nodes_apart(const grid::Grid& grid, grid::Cuts& cuts,
                                           std::span<const grid::EdgeId> edges);

} // namespace kerf::cut
