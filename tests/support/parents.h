#pragma once

/// Where the corners of a complex came from, for bodies whose complex is built anew instead of updated.

#include "grid/complex.h"

#include <bit>

namespace kerf::support {

inline unsigned material_of(const grid::CellComplex& complex, const grid::CellId cell) {
  unsigned material = 0;
  for (const grid::CopyId c : complex.copies_of(cell))
    material |= complex.copies[c].nodes;
  return material;
}

/// For each corner of `after`, the corner of `before` it came from. `after` must come from `before` by further cuts.
inline Table<grid::CornerId, grid::CornerId> parents(const grid::CellComplex& before, const grid::CellComplex& after) {
  Table<grid::CornerId, grid::CornerId> parent(after.n_corners());
  for (const grid::Copy& copy : after.copies) {
    const int item = std::countr_zero(copy.items());
    grid::CopyId at_before = before.copy_with(copy.cell, item);
    if (!at_before.valid()) // nothing had cut at the skin there: with the node under it
      at_before = before.copy_at(copy.cell, grid::skeleton_of(material_of(before, copy.cell)).vertex[item]);
    const grid::Copy& from = before.copies[at_before];
    for (int v = 0; v < 8; ++v)
      parent[copy.corners[v]] = from.corners[v];
  }
  return parent;
}

} // namespace kerf::support
