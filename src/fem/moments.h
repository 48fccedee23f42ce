#pragma once

/// Moments of the material in a cell: m(i, j, k) = integral of x^i y^j z^k over the material, in the unit cube [1].
/// A trilinear cube's mass and stiffness for any distribution of material are linear in the 27 moments i, j, k <= 2,
/// so a cut cell costs one set of moments, exact for every position of the cut.

#include "grid/solid.h"

#include <array>

namespace kerf::fem {

/// m(i, j, k) at i + 3 j + 9 k.
using Moments = std::array<double, 27>;

Moments full_cube_moments();

/// Moments of the octants of the given vertices (bits) of a cell.
Moments octant_moments(const grid::Solid& solid, grid::CellId cell, unsigned vertices);
/// The moments nearest to these, on the straight way to those of the same volume spread over the whole cube, under
/// which no trilinear field has a negative square: of slivers round-off makes such, and an element of them would gain
/// energy.
Moments without_negative_squares(const Moments& m);
/// Moments of all material of a copy. Material of less than 1e-12 of a cube counts as that much, spread over the whole
/// cube: for what a blade cuts off the skin alone may have hardly any.
Moments material_moments(const grid::Solid& solid, const grid::Copy& copy);

} // namespace kerf::fem
