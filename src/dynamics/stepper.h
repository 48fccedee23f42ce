#pragma once

#include "dynamics/loads.h"
#include "dynamics/state.h"

namespace kerf::dynamics {

struct StepReport {
  int n_iterations = 0; ///< of the linear solver, summed over the step
};

/// All that the main loop knows of a physics.
class Stepper {
 public:
  virtual ~Stepper() = default;

  /// Advances the state by dt [s]. Throws NumericalError when it cannot.
  virtual StepReport step(State& state, const Loads& loads, double dt) = 0;
};

} // namespace kerf::dynamics
