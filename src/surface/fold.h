#pragma once

/// Whether cuts are folded over the skin: then a part of a cell would have negative material (grid/material.h). With the
/// skin's own vertices in place of the cuts' hardly any has: in random cuts of bodies with a jagged skin 1e-4 cubes at a
/// corner, now and then. A part that holds no node may have a little: where the skin is hollow, a plane that cuts off one
/// of its points has material behind it, and what that part lacks others have too much, so that what lies on either side
/// is right. In a face alone nothing can be told: where a plane meets its border four times, what it leaves has the same
/// area wherever on the plane the vertex lies, and a part that is folded there may have material in both cells.

#include "surface/view.h"

namespace kerf::surface {

/// In a cell whose cuts' vertices are placed: has a part of it negative mass at one of its corners, or without a node
/// less than -.02 cubes?
bool is_folded(const grid::Solid& solid, const View& view);

} // namespace kerf::surface
