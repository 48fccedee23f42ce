#pragma once

/// Implicit Euler (Baraff and Witkin 1998, for one Newton iteration): solves
///
///     M (x - x_n - dt v_n) / dt^2 + (alpha M + beta K) (x - x_n) / dt = f(x) + M g + loads
///
/// for x at the end of the step by Newton's method from x_n (balance.h). The first guess of conjugate gradients is
/// that velocities change as in the step before, which the state remembers until a cut: free fall is guessed exactly.
/// First order, dissipative, stable for every dt. A scene's step tests its first correction, and goes on with a
/// line search where that does not bear it (Trust::tested).

#include "dynamics/newton_parameters.h"
#include "dynamics/stepper.h"

namespace kerf::dynamics {

struct ImplicitEulerOptions {
  int n_newton = 1;           ///< Newton iterations a step, at most; one is the linearly implicit method
  double cg_tolerance = 1e-6; ///< NewtonOptions::cg_tolerance
  int max_cg_iterations = 2000;
  double newton_tolerance = 0; ///< NewtonOptions::tolerance: a step that misses it is refused
  LineSearch line_search = LineSearch::none;
  LinearSolver solver = LinearSolver::conjugate_gradients;
  Tangent tangent = Tangent::positive;   ///< what the direct solver factorises
  double step_tolerance = 0;             ///< NewtonOptions::step_tolerance
  Trust trust = Trust::blind;            ///< NewtonOptions::trust
  std::vector<std::uint32_t> piece = {}; ///< NewtonOptions::piece
};
ImplicitEulerOptions implicit_euler_options(const NewtonParameters& parameters);

class ImplicitEuler : public Stepper {
 public:
  /// The model must outlive the stepper.
  ImplicitEuler(ElasticModel& model, const ImplicitEulerOptions& options);

  /// Throws NumericalError when Newton's method or conjugate gradients miss their tolerance.
  StepReport step(State& state, const Loads& loads, double dt) override;

 private:
  BalanceSolver solver_;
};

} // namespace kerf::dynamics
