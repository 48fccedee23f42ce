#pragma once

/// Where a cut passes below the skin, but above the bottom of a dent in it: what lies around the dent below the cut has
/// a border with a hole then, and the dent's skin, which closes the hole, hangs on it by no segment. By segments that
/// skin is a part of its own, of which the volume against the cut is negative: what is missing from the part around it.
/// Both are one.

#include "grid/parts.h"
#include "grid/solid.h"

namespace kerf::cut {

/// Items of a cell.
struct Dent {
  grid::Items skin, around;

  grid::Joined joined() const { return {skin | around, 0}; }
};

/// Of a cell in which blades have cut: each part without a node whose volume is negative, and the one whose border goes
/// around its own on the same side of the cut; as the cuts alone tell, wherever their vertices are. None where cuts of
/// several blades tell the sides of all parts (sides.h): what lies on the same sides is one by that, and a part between
/// them may seem to have a negative volume, and is no dent.
std::vector<Dent> dents(const grid::Solid& solid, grid::CellId c);

} // namespace kerf::cut
