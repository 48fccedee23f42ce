#pragma once

/// Where a cut opens a dent of the skin from behind. In the cut's surface a part of a cell then has a border with a hole,
/// and the skin of the dent, which closes the hole, hangs on the part by no segment. By segments it is a part of its
/// own, on the same side, and bounds what is missing from the one around it: less than nothing. Both are one.

#include "grid/parts.h"
#include "grid/solid.h"

namespace kerf::cut {

/// Of a cell in which blades have cut: each part that bounds less than nothing, with the one whose border goes around its
/// own. Parts that `known` joins with others are passed over.
std::vector<grid::Joined> dents(const grid::Solid& solid, grid::CellId c, const std::vector<grid::Joined>& known);

} // namespace kerf::cut
