#pragma once

/// Vertices that see less than all around them (sight.h) may have been good enough until another cut, or a front, came
/// into their cell. Where a part of it has less than nothing now, they are placed anew, from where they see all: in the
/// plane of the cuts around them where these have one and that is enough, else anywhere.

#include "grid/solid.h"

#include <cstddef>
#include <vector>

namespace kerf::surface {

/// Does that in cells, ascending, whose vertices are placed. Adds those beside them in whose faces a vertex has moved.
/// Where a front parts a cell, vertices are placed where there were none yet. Returns how many cells have less than
/// nothing in a part all the same, since nothing sees all around.
std::size_t unfold(grid::Solid& solid, std::vector<grid::CellId>& cells);

} // namespace kerf::surface
