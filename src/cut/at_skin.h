#pragma once

/// How cuts end at the skin: in which faces they part it (grid::Seam), and where they cut edges of the skin on the
/// way.
///
/// A blade's cut of an edge goes on as a plane as far as the faces of that edge reach: in a face of the skin it
/// leaves by another edge, or through the skin. So a cut next to the skin reaches it in the same step, and leaves no
/// bridge that the grid cannot see; where it leaves by an edge of the skin, below the skin, that edge is cut along
/// with it. Where the blade ends before, that is up to a cube edge too far, in the layer above the last nodes only.
///
/// An edge that another surface has cut keeps that cut when it is crossed again (grid/cuts.h), so that beside such
/// edges none may tell of the later cut. There the plane of what it cuts in the same cell does, in that cell and
/// around the edges that it crosses again, up to two cells away: it parts the skin of a face where its arc ends on
/// different sides.

#include "cut/target.h"

namespace kerf::cut {

/// Says what new cuts, which `cuts` holds already, do to the skin, where they are all that a surface without an end
/// inside the body cuts: in a face that they cut an odd number of times they leave through the skin. Adds edges that
/// were cut before at faces whose skin is parted now.
void part_skin(grid::Solid& solid, std::vector<grid::EdgeId>& new_edges);

/// Of cuts of edges of the skin by a blade, those that go on below the skin, in any face around them that can hold what
/// they cut off, when the corners are at `x`; `cuts` holds `new_edges` of the same step already. What is cut off a tip
/// of the skin alone is lost: a blade that passes along an edge would leave dust.
std::vector<grid::EdgeCut> cuts_that_go_on(const grid::Solid& solid, const Points& x,
                                           std::span<const grid::EdgeId> new_edges,
                                           std::span<const grid::EdgeCut> of_skin);

/// The same as part_skin for cuts of blades, which have ends, when the corners are at `x`; `complex` is that from
/// before the cuts. Cuts edges of the skin along with them. Returns those, and edges that were cut before at faces
/// whose skin is parted now.
std::vector<grid::EdgeId> end_at_skin(grid::Solid& solid, const Points& x, std::span<const grid::EdgeId> new_edges);

} // namespace kerf::cut
