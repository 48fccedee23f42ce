#pragma once

/// A support that holds a part of a body's surface, by penalty, where a Support holds corners.
///
/// A vertex i of the patch stands for A_i, a third of the rest area of its triangles. With the projector H onto what
/// is held and the place p_i(t) = R(t) X_i + d(t), the potential is the sum of 1/2 k A_i |H (W_i x - p_i)|^2, the force
/// on the vertex -k A_i H (W_i x - p_i) and the tangent k A_i W_i^T H W_i. It needs no corners on the surface: held
/// corners that lie beside it hold a body that is longer or shorter than its mesh.
/// Source: Wriggers, Computational Contact Mechanics (2006), ch. 5 (penalty).
/// Limits: under a stress sigma the patch gives way by sigma / k. With k = c E / h that is strain times h / c. Where
/// supports overlap, neither wins: a vertex goes to the mean of its places, weighted by their stiffness.

#include "dynamics/loads.h"
#include "dynamics/surface_load.h"

namespace kerf::dynamics {

class SkinSupport : public Load {
 public:
  /// stiffness k [N/m^3]; of `hold` its displacement, rotation and held directions, its corners are not looked at.
  /// Throws as check(), and ParameterError for a stiffness that is not positive. A patch without triangles holds
  /// nothing.
  SkinSupport(const SurfacePatch& patch, double stiffness, Support hold);

  Nature nature() const override { return Nature::conservative; } // at each fixed time
  double energy(double time, const Points& x) const override;
  void add_force(const Moment& moment, Points& forces) const override;
  void add_tangent(Tangent kind, const Moment& moment, double velocity_factor, LoadTangent& tangent) const override;

  /// Of the patch at rest [m^2].
  double area() const;

 private:
  Interpolation points_;      ///< the vertices of the patch
  Points rest_;               ///< theirs [m]
  std::vector<double> areas_; ///< theirs [m^2]
  double stiffness_;
  Support hold_;
};

} // namespace kerf::dynamics
