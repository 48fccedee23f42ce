#pragma once

/// Points of the skin that cuts have taken from all nodes, and that bound no material: where a blade passes along the
/// skin, or the skin is so hollow that a point of it lies on a blade's other side than its neighbours, though the material
/// there is not parted. They stay with their neighbours.

#include "grid/solid.h"

#include <vector>

namespace kerf::cut {

/// Takes new cuts of the skin back, so that no such points are left beside these segments, which `solid.cuts` holds and
/// `solid.complex` does not; takes those out of `segments`. Returns how many.
std::size_t leave_tips_whole(grid::Solid& solid, std::vector<grid::SkinSegment>& segments);

} // namespace kerf::cut
