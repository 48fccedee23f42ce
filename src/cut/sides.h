#pragma once

/// Which parts of a cell lie on the same side of all cuts, and so are one, though every way between them along segments
/// is cut: where two cuts cross at a small angle, the wedge between them is thinner than a cube, and nodes lie in it
/// here and there, with no edge from one to the next.
///
/// Who has met a segment is known by its cut, and by later ones of others (grid/cuts.h). To the normals of one label,
/// turned to one side, each meeting is a step of +1 or -1 from one end of the segment to the other; steps along ways
/// add up to how an item lies to the label. Where that depends on the way, for any label, as where a cut ends in the
/// cell or comes back beside itself, nothing is said of the cell. Parts between which the skin has a hollow are not one
/// (hollows.h).
///
/// Splinters of such a wedge lie in cells next to each other too, where it passes through the face between them with
/// none of the face's nodes in it. Its material in the face is seen on the face's segments: an *interval* between two
/// cuts that meet a segment lies on known sides of all, and belongs in each cell around to the part that lies so.
/// Copies that have an interval in common are glued as those are that have a node in common (grid/parts.h). Three cuts
/// leave two intervals of a line; a half of an arc that three meet, or a line that four meet, is not asked. Where the
/// wedge passes through a cell in which it has neither a node nor a point of the skin, nothing leads on (splinters.h).

#include "grid/parts.h"
#include "grid/solid.h"

namespace kerf::cut {

/// Are parts of two cells glued, of which the second lies across a face of the first?
inline bool are_glued_across(const grid::Part& part, const grid::Part& beyond, const int face) {
  return face % 2 == 1 ? grid::are_glued(part, beyond, face / 2) : grid::are_glued(beyond, part, face / 2);
}

/// The copy of a cell that holds some of these items.
grid::CopyId copy_of(const grid::Solid& solid, grid::CellId c, grid::Items items);

/// What of a cell lies on the same sides: all of it, and intervals beside no part of theirs. None where nothing
/// is said.
std::vector<grid::Joined> all_by_sides(const grid::Solid& solid, grid::CellId c);

/// Of these groups those of two or more parts, or of one with intervals.
std::vector<grid::Joined> by_sides(const grid::Solid& solid, grid::CellId c);
/// The same, and dents with what is around them (dents.h): what is one in a cell.
std::vector<grid::Joined> on_same_sides(const grid::Solid& solid, grid::CellId c);

/// What hangs together in a cell without some of its cuts, with the intervals that belong to it by by_sides(); and
/// dents with what is around them.
std::vector<grid::Joined> without_cuts(const grid::Solid& solid, grid::CellId c, grid::Segments cuts);

/// Of these groups what is one copy still, by copies: cuts that wait join nothing that was parted before they came.
std::vector<grid::Joined> undivided(const grid::Solid& solid, grid::CellId c, const std::vector<grid::Joined>& groups);

/// Of these groups what can be one: parts that are one copy already, or whose copies' corners have moved apart by less
/// than a quarter of a cube, with the corners at `x` [m]; and of intervals those beyond which, across a face, lies no
/// copy that has moved away so far. A copy is turned inside out where one of its faces moves by a cube against the
/// other, or both by half of one; joined corners are moved by a quarter at most, half of that.
std::vector<grid::Joined> near_each_other(const grid::Solid& solid, grid::CellId c, std::vector<grid::Joined> groups,
                                          const Points& x);

/// Are two items of a cell in one copy, or in two whose corners have moved apart by no more than that?
bool are_near(const grid::Solid& solid, grid::CellId c, const std::array<std::uint8_t, 2>& items, const Points& x);
/// Have two copies of a cell, at its faces in which some of these items lie?
bool are_near_at(const grid::Solid& solid, grid::CopyId a, grid::CopyId b, grid::Items items, const Points& x);

} // namespace kerf::cut
