#pragma once

/// Implicit Euler (Baraff and Witkin 1998, for one Newton iteration): solves
///
///     M (x - x_n - dt v_n) / dt^2 + (alpha M + beta K) (x - x_n) / dt = f(x) + M g
///
/// for x at the end of the step by Newton's method from x_n, each correction by conjugate gradients with the inverse
/// of the diagonal 3 x 3 blocks as preconditioner and free motion as first guess. First order, dissipative, stable
/// for every dt. Held corners are eliminated.

#include "dynamics/model.h"
#include "dynamics/stepper.h"

namespace kerf::dynamics {

struct ImplicitEulerOptions {
  int n_newton = 1; ///< Newton iterations a step; one is the linearly implicit method
  /// Residual over the forces that balance in it (elastic, weight, inertia), in the Euclidean norm [1]. Not over the
  /// right-hand side, which vanishes at rest and would be solved ever more exactly there.
  double cg_tolerance = 1e-6;
  int max_cg_iterations = 2000;
};

class ImplicitEuler : public Stepper {
 public:
  /// The model must outlive the stepper.
  ImplicitEuler(ElasticModel& model, const ImplicitEulerOptions& options) : model_(model), options_(options) {}

  StepReport step(State& state, const Loads& loads, double dt) override;

 private:
  void factorise(const std::vector<std::uint8_t>& held, double mass_factor, double stiffness_factor);

  ElasticModel& model_;
  ImplicitEulerOptions options_;
  std::vector<Mat3> blocks_, inverse_factors_; // of the stiffness' diagonal; of the Cholesky factors of the operator's
};

} // namespace kerf::dynamics
