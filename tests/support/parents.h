#pragma once

/// Where the corners of a complex came from, for bodies whose complex is built anew instead of updated.

#include "grid/complex.h"

#include <bit>

namespace kerf::support {

/// For each corner of `after`, the corner of `before` it came from. `after` must come from `before` by further cuts.
inline Table<grid::CornerId, grid::CornerId> parents(const grid::CellComplex& before, const grid::CellComplex& after) {
  Table<grid::CornerId, grid::CornerId> parent(after.n_corners());
  for (const grid::Copy& copy : after.copies) {
    grid::CopyId at_before = copy.nodes != 0 ? before.copy_at(copy.cell, std::countr_zero(copy.nodes)) : grid::CopyId();
    if (copy.nodes == 0) { // its rind, or the node from which that was cut off
      const int line = std::countr_zero(copy.rinds);
      at_before = before.copy_with_rind(copy.cell, line);
      for (const int end : grid::cube::line_vertices[line])
        if (!at_before.valid())
          at_before = before.copy_at(copy.cell, end);
    }
    const grid::Copy& from = before.copies[at_before];
    for (int v = 0; v < 8; ++v)
      parent[copy.corners[v]] = from.corners[v];
  }
  return parent;
}

} // namespace kerf::support
