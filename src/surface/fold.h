#pragma once

/// Whether cuts are folded over the skin: then a part of a cell would have negative material (grid/material.h). With
/// the skin's own vertices in place of the cuts' hardly any has: in random cuts of bodies with a jagged skin 1e-4 cubes
/// at a corner, now and then. A part that holds no node may have a little: where the skin is hollow, a plane that cuts
/// off one of its points has material behind it, and what that part lacks others have too much, so that what lies on
/// either side is right.

#include "surface/view.h"

namespace kerf::surface {

/// In a cell whose cuts' vertices are placed: has a part of it negative mass at one of its corners, or without a node
/// less than -.02 cubes?
bool is_folded(const grid::Solid& solid, const View& view);

/// With a vertex of the cuts at p in a side of the cell's skeleton that lies in a face: has a part of it negative area,
/// in the same sense?
bool is_folded(const grid::Solid& solid, const View& view, int side, const Vec3& p);

} // namespace kerf::surface
