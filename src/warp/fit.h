#pragma once

/// Maps that take given points to given points, or a closed curve to another, and relax elsewhere, without a fold: how
/// a photographed section is drawn to the outline of another (thesis §3.4.2.3).

#include "warp/curve.h"
#include "warp/energy.h"

namespace kerf::warp {

struct FitOptions {
  Regularity inside = Regularity::rigid; ///< jacobian: harmonic
  int n_cells = 32;                      ///< of the finest lattice along the longer side of the rectangle
  /// Of the finest lattice; the coarser are stiffer. Much softer ones follow the boundary's pixels, with ripples
  /// inside.
  double stiffness = 1;
  /// Against triangles of less than half their area: what is crushed smears a pixel over a band of the section.
  /// Boundary points that ask for it give way; they then lie better, not worse, than where crushed cells hold the map
  /// back.
  double barrier = 3;
};

/// The affine map that neither turns nor mirrors (its linear part is symmetric and positive) and takes the moments of
/// what one curve bounds to those of the other.
Affine affine_between(const Curve& from, const Curve& to);

/// The map of a rectangle, coarse to fine from an affine map, which costs nothing. No triangle of its lattice is
/// flipped.
LatticeMap fit(const std::vector<Pin>& pairs, const Affine& start, const Vec2& lower, const Vec2& upper,
               const FitOptions& options);

/// The same for two curves, from the affine map between them. As the map comes closer, points look for their partners
/// anew, so that they may slide along the curve. Both turn in the same sense and lie much as they will. `section` spans
/// the rectangle by its pixels and says what the first curve bounds: outside of it the map is soft, and bays may close.
LatticeMap fit(const Curve& from, const Curve& to, const image::Grey& section, const Vec2& lower, const Vec2& upper,
               const FitOptions& options);

} // namespace kerf::warp
