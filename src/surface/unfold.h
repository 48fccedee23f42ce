#pragma once

/// Vertices that see less than all around them (sight.h) may have been good enough until another cut, or a front, came
/// into their cell. Where a part of it has less than nothing now, they are placed anew, from where they see all.

#include "grid/solid.h"

#include <vector>

namespace kerf::surface {

/// Does that in cells, ascending, whose vertices are placed. Adds those beside them in whose faces a vertex has moved.
void unfold(grid::Solid& solid, std::vector<grid::CellId>& cells);

} // namespace kerf::surface
