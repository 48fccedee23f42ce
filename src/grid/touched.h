#pragma once

/// The cells around edges, and by which of their lines they are among them.

#include "grid/cuts.h"

#include <span>
#include <vector>

namespace kerf::grid {

struct TouchedCell {
  CellId cell;
  std::uint16_t lines = 0; ///< bits of the cell's lines that are among the edges
};

/// The stored cells around any of these edges, ascending, each once. Takes time by the number of edges, and of all
/// cells only where the edges are many.
std::vector<TouchedCell> touched_cells(const Grid& grid, std::span<const EdgeId> edges);

/// The cells with a cut edge, ascending, with their configurations.
std::vector<TouchedCell> touched_cells(const Grid& grid, const Cuts& cuts);

/// The stored cells around edges, and those that segments of the skin belong to; ascending, each once.
std::vector<CellId> touched_cells(const Grid& grid, std::span<const EdgeId> edges,
                                  std::span<const SkinSegment> segments);

} // namespace kerf::grid
