#pragma once

/// Where the corners of a complex came from, for bodies whose complex is built anew instead of updated.

#include "grid/solid.h"

#include <bit>

namespace kerf::support {

/// For each corner of the body, the corner of `before` it came from. Its complex must come from that by further cuts.
inline Table<grid::CornerId, grid::CornerId> parents(const grid::CellComplex& before, const grid::Solid& body) {
  const grid::CellComplex& after = body.complex;
  Table<grid::CornerId, grid::CornerId> parent(after.n_corners());
  for (const grid::Copy& copy : after.copies) {
    const int item = std::countr_zero(copy.items());
    grid::CopyId at_before = before.copy_with(copy.cell, item);
    if (!at_before.valid()) // a point of the skin that was not cut yet: with the node below
      at_before = before.copy_at(copy.cell, grid::skeleton_of(grid::material_of(body.grid, copy.cell)).vertex[item]);
    const grid::Copy& from = before.copies[at_before];
    for (int v = 0; v < 8; ++v)
      parent[copy.corners[v]] = from.corners[v];
  }
  return parent;
}

} // namespace kerf::support
