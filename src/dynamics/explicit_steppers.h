#pragma once

/// Explicit integrators beside symplectic Euler (thesis §2.1.3, eqs. 2.14, 2.17). F is all force, a = M^-1 F.
///
/// Explicit Euler: x += dt v, v += dt a(x, v), both from the start. First order; undamped vibrations grow by
/// (w dt)^2 / 2 a step.
///
/// Midpoint Runge-Kutta: x += dt v', v += dt a(x', v') with x', v' after half an explicit Euler step. Second order;
/// undamped vibrations grow by (w dt)^4 / 8 a step.
///
/// Velocity Verlet (Swope and others 1982): v += dt/2 a, x += dt v, v += dt/2 a. Second order, symplectic, stable for
/// dt below 2 / (largest frequency). Mass damping is explicit in the first half and implicit in the second; other
/// forces of velocity are predicted for the second half by v + dt/2 a, which keeps second order.
///
/// Held components follow their places, with their velocity.

#include "dynamics/explicit_stepper.h"

namespace kerf::dynamics {

class ExplicitEuler : public ExplicitStepper {
 public:
  /// The model must outlive the stepper.
  ExplicitEuler(ElasticModel& model, const ExplicitOptions& options) : ExplicitStepper(model, scheme(), options) {}

  static ExplicitScheme scheme();

 private:
  SumsOfStep move(const Step& step, Points& x, Points& v) override;
};

class MidpointRungeKutta : public ExplicitStepper {
 public:
  /// The model must outlive the stepper.
  MidpointRungeKutta(ElasticModel& model, const ExplicitOptions& options) : ExplicitStepper(model, scheme(), options) {}

  static ExplicitScheme scheme();

 private:
  SumsOfStep move(const Step& step, Points& x, Points& v) override;
};

class VelocityVerlet : public ExplicitStepper {
 public:
  /// The model must outlive the stepper.
  VelocityVerlet(ElasticModel& model, const ExplicitOptions& options) : ExplicitStepper(model, scheme(), options) {}

  static ExplicitScheme scheme();

 private:
  SumsOfStep move(const Step& step, Points& x, Points& v) override;
};

} // namespace kerf::dynamics
