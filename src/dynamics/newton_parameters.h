#pragma once

/// What all implicit integrators share towards a scene: the keys of Newton's method, and what a step makes of its
/// report.

#include "base/parameters.h"
#include "dynamics/balance.h"
#include "dynamics/stepper.h"

namespace kerf::dynamics {

struct NewtonParameters {
  int n_newton = 1;
  double newton_tolerance = 0; ///< [1]
  bool line_search = false;
  std::string solver = "conjugate gradients";
  std::string tangent = "positive";
  double cg_tolerance = 1e-6; ///< [1]
  int max_cg_iterations = 2000;

  void describe(Parameters& p);
  NewtonOptions options() const;
};

/// What a step reports of a solution; throws NumericalError when that has not converged.
StepReport accepted(const NewtonReport& report);

} // namespace kerf::dynamics
