#pragma once

/// Symplectic Euler (thesis §2.1.3, eqs. 2.15, 2.16): v += dt M^-1 f(x, v), then x += dt v. First order, explicit,
/// stable for dt below 2 / (largest frequency). Mass damping is taken implicitly, so it never destabilises.

#include "dynamics/stable_step.h"
#include "dynamics/stepper.h"

namespace kerf::dynamics {

class SymplecticEuler : public Stepper {
 public:
  /// Goes on beyond the stable step. The model must outlive the stepper.
  explicit SymplecticEuler(ElasticModel& model) : SymplecticEuler(model, {BeyondStable::go_on}) {}
  SymplecticEuler(ElasticModel& model, const ExplicitOptions& options)
    : model_(model), limit_(model, scheme(), options) {}

  StepReport step(State& state, const Loads& loads, double dt) override;
  void archive(Archive& a) override { limit_.archive(a); }
  static ExplicitScheme scheme();

 private:
  ElasticModel& model_;
  StepLimit limit_;
  Points force_;
};

} // namespace kerf::dynamics
