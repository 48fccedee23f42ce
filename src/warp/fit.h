#pragma once

/// A map that takes a closed curve to another and relaxes inside, without a fold: how a photographed section is drawn to
/// the outline of another (thesis §3.4.2.3).

#include "warp/curve.h"
#include "warp/energy.h"

namespace kerf::warp {

struct FitOptions {
  Regularity inside = Regularity::rigid; ///< jacobian: harmonic
  int n_cells = 32;                      ///< of the finest lattice along the longer side of the rectangle
  double stiffness = 0.3;                ///< of the finest lattice; the coarser are stiffer
  double barrier = 3;                    ///< against triangles of less than half their area
  int n_rounds = 3;                      ///< in which the finest lattice is drawn to the curve ever harder
};

/// The affine map that takes `from` to `to` best in the least squares sense, point by point. The points must not lie on
/// one line.
Affine best_affine(const Curve& from, const Curve& to);

/// The map of a rectangle that takes one curve to another, coarse to fine. What takes them to each other best as an
/// affine map costs nothing; as the map comes closer, points look for their partners anew, so that they may slide along
/// the curve. Both turn in the same sense and lie much as they will, neither turned nor mirrored. `section` spans the
/// rectangle by its pixels and says what the first curve bounds: outside of it the map is soft, and bays may close. No
/// triangle of its lattice is flipped.
LatticeMap fit(const Curve& from, const Curve& to, const image::Grey& section, const Vec2& lower, const Vec2& upper,
               const FitOptions& options);

} // namespace kerf::warp
