#pragma once

/// A map that takes given points to given points and relaxes between them, without a fold: how a photographed section
/// is drawn to the outline of another (thesis §3.4.2.3).

#include "warp/energy.h"

namespace kerf::warp {

struct FitOptions {
  Regularity inside = Regularity::rigid; ///< jacobian: harmonic
  int n_cells = 32;                      ///< of the finest lattice along the longer side of the rectangle
  /// Of the finest lattice; the coarser are stiffer. Much softer ones follow the boundary's pixels, with ripples inside.
  double stiffness = 1;
  /// Against triangles of less than half their area: what is crushed smears a pixel over a band of the section. Boundary
  /// points that ask for it give way; they then lie better, not worse, than where crushed cells hold the map back.
  double barrier = 3;
};

/// The similarity, without reflection, that takes `from` to `to` best in the least squares sense. At least two
/// different points.
Affine best_similarity(const std::vector<Pin>& pairs);

/// The map of a rectangle, from the best similarity coarse to fine. No triangle of its lattice is flipped.
LatticeMap fit(const std::vector<Pin>& pairs, const Vec2& lower, const Vec2& upper, const FitOptions& options);

} // namespace kerf::warp
