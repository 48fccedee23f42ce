#pragma once

/// The border of a cut within a cell with skin, and from where all of it is seen. A cell's triangles of the cut are a
/// fan from its vertex to the border, which runs from cut to cut of its segments through the vertices in its sides.
/// Where that vertex does not see some piece of the border from within, the triangle to it is folded over others. A
/// jagged skin has cuts whose borders are hollow.

#include "surface/view.h"

#include <optional>

namespace kerf::surface {

/// Where border_is_in_plane(): a point from where the whole border is seen, p or in the middle of all such points. None
/// where no point sees it.
std::optional<Vec3> point_that_sees_border(const grid::Solid& solid, const View& view, const Vec3& p);

/// Do all cuts of the cell, and the vertices in its sides, lie in one plane with p? Then what the cut leaves on its
/// sides is the same for any point of it, whatever that sees.
bool border_is_in_plane(const grid::Solid& solid, const View& view, const Vec3& p);

/// The cut segments whose cuts lie on the same border as that of `segment`: a thin part of the body leaves two.
grid::Segments border_of(const grid::Skeleton& skeleton, grid::Segments cut, int segment);

/// Where the fan to one of several borders has its vertex, in a cell whose cuts' vertex is placed: where it sees that
/// border, if all cuts of the cell lie in one plane; else at the cell's vertex.
Vec3 vertex_of_border(const grid::Solid& solid, grid::CellId cell, grid::Segments border);

} // namespace kerf::surface
