#include "dynamics/newton_parameters.h"

#include "base/error.h"

namespace kerf::dynamics {

void NewtonParameters::describe(Parameters& p) {
  p.integer(
    "Newton iterations [1]", n_newton, {.min = 1},
    "At most, a step; 1 is the linearly implicit method. Implicit Euler goes on where a first one, not searched, "
    "does not bear its tests.");
  p.number("Newton tolerance [1]", newton_tolerance, non_negative,
           "Forces out of balance over the forces that balance. 0: always all iterations, and no test.");
  p.boolean("Line search", line_search, "Shorten corrections until the energy of the step falls.");
  p.choice("Solver", solver, {"conjugate gradients", "direct"}, "Of the linear equations.");
  p.choice("Tangent", tangent, {"positive", "exact"}, "What the direct solver factorises.");
  p.number("CG tolerance [1]", cg_tolerance, {.min = 0, .max = 1, .min_excluded = true, .max_excluded = true},
           "Residual over the forces that balance; implicit Euler also stops at 1e3 times this over its own error.");
  p.integer("CG iterations [1]", max_cg_iterations, {.min = 1}, "At most, a linear equation.");
}

NewtonOptions NewtonParameters::options() const {
  const bool goes_on = newton_tolerance > 0 && line_search;
  return {.max_iterations = n_newton,
          .tolerance = newton_tolerance,
          .line_search = line_search ? LineSearch::backtracking : LineSearch::none,
          .solver = solver == "direct" ? LinearSolver::direct : LinearSolver::conjugate_gradients,
          .tangent = tangent == "exact" ? Tangent::exact : Tangent::positive,
          .cg_tolerance = cg_tolerance,
          .max_cg_iterations = max_cg_iterations,
          .n_mixed = goes_on && tangent != "exact" ? 5 : 0}; // of 3 to 12, 5 and more take the fewest iterations
}

StepReport accepted(const NewtonReport& report) {
  if (!report.converged)
    throw NumericalError("Newton's method left " + to_text(report.residual) + " of the forces out of balance after " +
                         std::to_string(report.n_newton) + " iterations" +
                         (report.failure.empty()
                            ? ". Use a smaller time step, more Newton iterations or a larger Newton tolerance"
                            : ": " + report.failure + ". Use a smaller time step"));
  return {.n_iterations = report.n_linear, .n_newton = report.n_newton, .residual = report.residual};
}

} // namespace kerf::dynamics
