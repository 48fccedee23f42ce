#pragma once

/// The rotation nearest a deformation gradient.

#include "base/vec.h"

namespace kerf::material {

/// R of the polar decomposition F = R S, always a proper rotation: where F is inverted (det F < 0), the direction of
/// least stretch is taken as the inverted one (Irving, Teran and Fedkiw 2004, section 4); where F collapses, one of
/// the nearest rotations. Newton's iteration of Higham (1986) where F is well away from singular, else a singular
/// value decomposition.
Mat3 rotation_of(const Mat3& F);

} // namespace kerf::material
