#pragma once

/// Where the surface of a cut ends in a cell with a front (grid::Front): as far as that has come, in place of halfway
/// through.

#include "grid/solid.h"

#include <optional>

namespace kerf::surface {

/// In a face of the cell, where the front's plane and end cross it; the nearest point of the plane there where the end
/// lies beyond the face. None without a front in either cell of the face, or where the plane does not cross it.
std::optional<Vec3> end_in_face(const grid::Solid& solid, grid::CellId c, int face);

/// In the middle of the front's end in the cell. None without a front there.
std::optional<Vec3> end_in_cell(const grid::Solid& solid, grid::CellId c);

} // namespace kerf::surface
