#pragma once

/// The vertex of cuts in a triangle of a cell's skin.

#include "surface/view.h"

#include <optional>

namespace kerf::surface {

/// On the skin itself: halfway between two cuts of the triangle's sides, and so on the rim. A cut of the third side
/// meets it there, where the rim crosses that cut's plane. One cut alone goes on in its plane; so does the first of
/// those of different labels that do not meet in the triangle, which is cut. None where its place is settled.
std::optional<Vec3> point_in_triangle(const grid::Solid& solid, const View& view, int triangle);

} // namespace kerf::surface
