#pragma once

/// Lattice shape matching as a stepper (Rivers and James 2007; thesis §5.1). With the goals g of Matching, in a step
/// dt:
///
///     v of corners of hardly any mass damped against what carries them (riders.h),
///     v += alpha (g - x) / dt + dt gravity,    alpha = k dt^2,
///     v += kappa (u - v)                       u: the regions' mean rigid velocities (their region damping),
///     x += dt v.
///
/// That is symplectic Euler on Matching's energy. No curvature of that energy exceeds k m_c, so with alpha <= 1 every
/// frequency stays a factor two and more below the limit 2 / dt: no length of a region, mass of a sliver or state makes
/// it unstable. Without gravity and supports it keeps momentum and angular momentum to round-off, damped or not.
///
/// Damping: kappa = c dt / (1 + c dt), c the region damping [1/s] and beta k of the load's stiffness damping (whose
/// K v is k M (v - u), linearised).
///
/// Loads at corners act on the regions: their accelerations pass through the same means of rigid motions as u, which
/// keep the resultant and the torque, and under which a corner that only a sliver holds does not fly away from its
/// body.
///
/// Limits: a larger alpha asks for a smaller dt or larger regions (calibration.h). Loads are taken explicitly, and
/// those that are stiff themselves bound dt.

#include "base/parameters.h"
#include "dynamics/constraints.h"
#include "dynamics/stepper.h"
#include "lattice/matching.h"

namespace kerf::lattice {

struct ShapeMatchingParameters {
  int half_width = 2;
  double alpha = 1;
  double region_damping = 0;

  void describe(Parameters& p);
};

/// Throws ParameterError about the first value that describe() does not allow.
void check(const ShapeMatchingParameters& parameters);

/// k = alpha / dt^2 [1/s^2] and so on, after a check.
MatchingOptions matching_options(const ShapeMatchingParameters& parameters, double density, double dt);

class ShapeMatching : public dynamics::Stepper {
 public:
  /// The model must outlive the stepper. Region damping in [1/s].
  ShapeMatching(const Matching& model, double region_damping);

  /// Throws ParameterError when alpha = k dt^2 exceeds 1.
  dynamics::StepReport step(dynamics::State& state, const dynamics::Loads& loads, double dt) override;

 private:
  void add_loads(const dynamics::Moment& now, const dynamics::Loads& loads, double dt, Points& v);
  void damp(const Points& x, const dynamics::Loads& loads, double dt, Points& v);

  const Matching& model_;
  double region_damping_;
  Points goals_, rigid_;
};

} // namespace kerf::lattice
