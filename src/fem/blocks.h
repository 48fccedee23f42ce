#pragma once

/// The cells of a grid in chunks, each of them a block: a cut meets few of them, and they share few corners.

#include "grid/grid.h"

#include <cstdint>
#include <vector>

namespace kerf::fem {

/// Cells, and where each chunk ends.
struct CellsInChunks {
  std::vector<grid::CellId> cells;
  std::vector<std::uint32_t> ends;     ///< in `cells`, ascending
  std::vector<std::uint32_t> chunk_of; ///< by cell
};

/// In blocks of 16 x 8 x 4 cells, with rows along x that a batch fits: they are counted from the first cell of each row
/// that has no skin. Chunks end between rows, with some 512 cells.
CellsInChunks in_chunks(const grid::Grid& grid);

} // namespace kerf::fem
