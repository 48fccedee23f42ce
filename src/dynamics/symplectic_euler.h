#pragma once

/// Symplectic Euler (thesis §2.1.3, eqs. 2.15, 2.16): v += dt M^-1 f(x, v), then x += dt v. First order, explicit,
/// stable for dt below 2 / (largest frequency). Mass damping is taken implicitly, so it never destabilises.

#include "dynamics/explicit_stepper.h"

namespace kerf::dynamics {

class SymplecticEuler : public ExplicitStepper {
 public:
  /// Goes on beyond the stable step. The model must outlive the stepper.
  explicit SymplecticEuler(ElasticModel& model) : SymplecticEuler(model, {BeyondStable::go_on}) {}
  SymplecticEuler(ElasticModel& model, const ExplicitOptions& options)
    : ExplicitStepper(model, scheme(), options) {}

  static ExplicitScheme scheme();

 private:
  SumsOfStep move(const Step& step, Points& x, Points& v) override;
};

} // namespace kerf::dynamics
