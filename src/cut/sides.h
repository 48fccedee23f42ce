#pragma once

/// Which parts of a cell lie on the same side of all cuts, and so are one, though every way between them along segments
/// is cut: where two cuts cross at a small angle, the wedge between them is thinner than a cube, and nodes lie in it
/// here and there, with no edge from one to the next.
///
/// Who has met a segment is known by its cut, and by later ones of others (grid/cuts.h). To the normals of one label,
/// turned to one side, each meeting is a step of +1 or -1 from one end of the segment to the other; steps along ways add
/// up to how an item lies to the label. Where that depends on the way, for any label, as where a cut ends in the cell or
/// comes back beside itself, nothing is said of the cell.

#include "grid/solid.h"

namespace kerf::cut {

/// Items of a cell, in groups that lie on the same sides, of two or more parts each.
std::vector<grid::Items> on_same_sides(const grid::Solid& solid, grid::CellId c);

/// Of these groups what can be one: parts that are one copy already, or whose copies' corners have moved apart by less
/// than a quarter of a cube, with the corners at `x` [m]: a copy is turned inside out where one of its faces moves by a
/// cube against the other, or both by half of one; joined corners are moved by a quarter at most, half of that.
std::vector<grid::Items> near_each_other(const grid::Solid& solid, grid::CellId c, std::vector<grid::Items> groups,
                                         const Points& x);

} // namespace kerf::cut
