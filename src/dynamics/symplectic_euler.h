#pragma once

/// Symplectic Euler (thesis §2.1.3): v += dt M^-1 f(x), then x += dt v. First order, explicit, stable for dt below
/// 2 / (largest frequency). Mass damping is taken implicitly, so it never destabilises.

#include "dynamics/model.h"
#include "dynamics/stepper.h"

namespace kerf::dynamics {

class SymplecticEuler : public Stepper {
 public:
  /// The model must outlive the stepper.
  explicit SymplecticEuler(ElasticModel& model) : model_(model) {}

  StepReport step(State& state, const Loads& loads, double dt) override;

 private:
  ElasticModel& model_;
  Points force_, damping_;
};

} // namespace kerf::dynamics
