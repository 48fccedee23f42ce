#pragma once

/// Where two cuts cross in the skin of a cell, off its segments.
///
/// A segment of the skin is cut once, by the cut that comes first. Where a second one meets a spoke too, what lies between
/// the two belongs to a part on the other side of the spoke. If the spoke's vertex stayed on the spoke, the second cut's
/// rim would go round by there, and leave its plane. Inside the cell the skin is ours to divide, so the vertex goes along
/// the first cut to where both cross in the triangle beside: the rims of both are straight, and no part loses anything.
/// That is so where the skin is flat: over a crease the body would lose what a chord cuts off. Segments in faces are
/// shared with the cells across, whose material would leave its cube: their vertices stay.

#include "surface/view.h"

namespace kerf::surface {

/// What is left of the way there, which is shorter than h: in the same place, vertices of a rim would make triangles
/// without area; so they stay in their order. As much as leaves them within 1e-6 h of both planes [1].
constexpr double short_of_crossing = 9e-7;

/// Moves the vertices of spokes to the crossings of the two cuts that meet them. Returns the triangles (bits, counted
/// from skeleton::first_triangle) beside what has moved, whose own vertices are to be placed anew.
grid::Sides move_to_crossings(grid::Solid& solid, const View& view);
bool has_crossings(const grid::Solid& solid, grid::CellId cell);
/// All of the cell go back onto their spokes; returns the same.
grid::Sides take_back_crossings(grid::Solid& solid, const View& view);

} // namespace kerf::surface
