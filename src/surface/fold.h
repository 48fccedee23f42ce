#pragma once

/// Whether the skin of a cell or face is folded under its cuts. Material between cuts and skin has a signed volume
/// (grid/material.h); where the skin is rough as the grid, a cut's vertices may come to lie so that a part of it is
/// negative. With the skin's vertices in place of the cuts' it never is.

#include "surface/view.h"

namespace kerf::surface {

/// Has a part of the cell negative mass at one of its corners?
bool is_folded(const grid::Solid& solid, const View& view);

/// Does the line of the skin in a face pass below the cuts' vertex p, seen from one of its ends? `skin` is the skin's
/// vertex.
/// By more than `little` of the cells' side, an area in h^2: where the skin is hollow, a rim on it lies a little deep.
bool is_folded(const View& view, int face, const Vec3& p, const grid::SkinPoint& skin, double little = 0);

} // namespace kerf::surface
