#pragma once

/// Two-step backward differences (BDF2) for positions and velocities: with the step before r times shorter,
///
///     dt v_1 = c_1 x_1 + c_0 x_0 + c_m x_m,   c_1 = (1 + 2 r) / (1 + r), c_0 = -(1 + r), c_m = r^2 / (1 + r),
///
/// and a_1 from v likewise (Hairer, Norsett, Wanner, Solving ODEs I, III.5); r = dt / (step before). Second order,
/// L-stable for equal steps: what is not resolved dies at once. The first step, and one more than 1 + sqrt 2 times as
/// long as that before, is implicit Euler, which leaves second order. Corners without mass follow (followers.h).
///
/// State::history "position before" [m], "velocity before" [m/s]; State::numbers "step before [s]".

#include "dynamics/newton_parameters.h"

namespace kerf::dynamics {

class Bdf2 : public Stepper {
 public:
  /// The model must outlive the stepper.
  Bdf2(ElasticModel& model, const NewtonOptions& options) : model_(model), solver_(model, options) {}

  StepReport step(State& state, const Loads& loads, double dt) override;

 private:
  ElasticModel& model_;
  BalanceSolver solver_;
};

} // namespace kerf::dynamics
