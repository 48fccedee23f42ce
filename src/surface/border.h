#pragma once

/// The border of a cut within a cell with skin, and from where all of it is seen. A cell's triangles of the cut are a
/// fan from its vertex to the border, which runs from cut to cut of its segments through the vertices in its sides.
/// Where that vertex does not see some piece of the border from within, the triangle to it is folded over others. A
/// jagged skin has cuts whose borders are hollow.

#include "surface/view.h"

#include <optional>

namespace kerf::surface {

/// Where all cuts of the cell lie in one plane, and a point of it at `p` does not see the whole border: one that does,
/// in the middle of all that do. None where p does, or no point. What the cut leaves on its sides is the same for any
/// point of the plane.
std::optional<Vec3> point_that_sees_border(const grid::Solid& solid, const View& view, const Vec3& p);

/// The cut segments whose cuts lie on the same border as that of `segment`: a thin part of the body leaves two.
grid::Segments border_of(const grid::Skeleton& skeleton, grid::Segments cut, int segment);

/// Where the fan to one of several borders has its vertex, in a cell whose cuts' vertex is placed: where it sees that
/// border, if all cuts of the cell lie in one plane; else at the cell's vertex.
Vec3 vertex_of_border(const grid::Solid& solid, grid::CellId cell, grid::Segments border);

} // namespace kerf::surface
