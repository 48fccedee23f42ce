#pragma once

/// Where the corners of a complex came from, for bodies whose complex is built anew instead of updated.

#include "grid/complex.h"

#include <bit>

namespace kerf::support {

/// For each corner of `after`, the corner of `before` it came from. `after` must come from `before` by further cuts.
inline Table<grid::CornerId, grid::CornerId> parents(const grid::CellComplex& before, const grid::CellComplex& after) {
  Table<grid::CornerId, grid::CornerId> parent(after.n_corners());
  for (const grid::Copy& copy : after.copies) {
    const grid::Copy& from = before.copies[before.copy_at(copy.cell, std::countr_zero(copy.nodes))];
    for (int v = 0; v < 8; ++v)
      parent[copy.corners[v]] = from.corners[v];
  }
  return parent;
}

} // namespace kerf::support
