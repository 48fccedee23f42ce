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

/// For methods of second order: one iteration would leave them first order in nonlinear bodies.
inline NewtonParameters converged_newton() {
  return {
    .n_newton = 20, .newton_tolerance = 1e-6, .line_search = true, .cg_tolerance = 1e-8, .max_cg_iterations = 20000};
}

/// What a step reports of a solution; throws NumericalError when that has not converged.
StepReport accepted(const NewtonReport& report);

} // namespace kerf::dynamics
