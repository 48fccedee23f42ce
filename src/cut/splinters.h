#pragma once

/// Splinters of a wedge between two blades' cuts. Where the wedge is thinner than a cube it passes through cells in
/// which it has neither a node nor a point of the skin: nothing of the grid holds what nodes it has beyond to the rest
/// of it (sides.h). Less than a cube of it is *held* by what lies nearest across a cut: it goes with that piece, which
/// so has a little more than a Boolean would leave it, and the wedge as much less. That it is a splinter, and not a
/// small piece by itself, is told by intervals, which lead from it to other material between the same cuts.

#include "grid/solid.h"

#include <set>
#include <span>
#include <vector>

namespace kerf::cut {

/// Parts on both sides of a cut that are one in a cell.
struct HeldSplinter {
  grid::CellId cell;
  grid::Items inner = 0;   ///< of the splinter
  grid::Joined parts;      ///< it, and what holds it
  std::size_t n_cells = 0; ///< in which the splinter lies

  void archive(Archive& a) { a(cell, inner, parts, n_cells); }
};

/// Of splinters that have a part in one of these cells, near to an interval or where one was held before; none that
/// reach into a cell where blades still cut (`unsettled`). One that was held stays so, while there is other material
/// between the same cuts, though vertices that have moved since make it the larger part; one that has come to lie in
/// more cells hangs together with more by now, and is asked as if it were new. With the corners at `x` [m]: what has
/// moved away by a quarter of a cube holds nothing.
std::vector<HeldSplinter> held_splinters(const grid::Solid& solid, std::span<const grid::CellId> cells,
                                         std::span<const HeldSplinter> held_before,
                                         const std::set<grid::CellId>& unsettled, const Points& x);

} // namespace kerf::cut
