#pragma once

/// What a cut would part from the body, and the grid cannot show: it stays where it hangs.
///
/// Tips are points of the skin that bound at most 1e-3 of a cube: where a blade passes along the skin. They stay with all
/// their neighbours across the blade, unless something beside them lies on the same side of all cuts, in a cell of theirs
/// or across a face of it (sides.h), or around them (dents.h): then they hang on that.
///
/// Shavings are a few nodes, or points of the skin, between cuts of one blade on opposite sides, with less material
/// than a cube: where a blade comes back through a body that has moved, beside where it was before. The grid has nodes
/// here and there in what lies between, and would show crumbs. They stay by that one of the new cuts that comes nearest
/// to them. What different blades part is parted, however thin, and so is what one blade cuts off from one side.

#include "grid/parts.h"
#include "grid/solid.h"

#include <functional>
#include <vector>

namespace kerf::cut {

/// Takes back new cuts that part tips and shavings from the body; that they were met is remembered, as of later cuts
/// (grid/cuts.h), since it tells on which side of them what is around lies. What another blade has met in the same step,
/// too, is then cut by that one. `edges` and `segments`, ascending, are what `solid.cuts` holds and `solid.complex` does
/// not; what is left whole leaves them.
void leave_shreds(grid::Solid& solid, std::vector<grid::EdgeId>& edges, std::vector<grid::SkinSegment>& segments);

/// The cuts of a cell, as they are or as they would be.
using CutsOfCell = std::function<grid::CellCuts(grid::CellId)>;

/// Does an item of a cell hang together with so little that it could be a shred? A cube that nothing cuts is more.
bool is_small(const grid::Solid& solid, grid::CellId cell, int item, const CutsOfCell& cuts_of);

} // namespace kerf::cut
