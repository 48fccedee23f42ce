#pragma once

/// Newmark's method (1959) and generalised alpha (Chung and Hulbert 1993, A time integration algorithm for structural
/// dynamics with improved numerical dissipation, J. Appl. Mech. 60): with
///
///     x_1 = x_0 + dt v_0 + dt^2 ((1/2 - beta) a_0 + beta a_1),   v_1 = v_0 + dt ((1 - gamma) a_0 + gamma a_1)
///
/// the balance of forces holds at x_0 + (1 - alpha_f)(x_1 - x_0), v likewise, and a_0 + (1 - alpha_m)(a_1 - a_0).
/// Forces are those of the configuration in between, not a mean of forces: the same for linear bodies. The spectral
/// radius at high frequency, rho_inf, chooses all four numbers (their eqs. 17, 18, 25): second order, stable for
/// every dt, and no more damping at low frequency than needed. Newmark is alpha_m = alpha_f = 0; average acceleration
/// beta = 1/4, gamma = 1/2 keeps the energy of linear bodies.
///
/// A corner without mass follows (followers.h): the balance gives its place y where it holds, whatever its place before.
/// From there it goes on to the step's end as its leaders do. Extrapolated from the step's start as they are, it
/// would swing about y with the factor -alpha_f / (1 - alpha_f), for ever where rho_inf is 1.
///
/// State::history "acceleration" [m/s^2] is a_0; without it the balance of forces at the start gives it. Followers are
/// not in balance there yet: what pulls at them is given to their leaders, with the weights that lead them, so that
/// forces which keep the body's momentum still do.

#include "dynamics/newton_parameters.h"

namespace kerf::dynamics {

struct AlphaCoefficients {
  double alpha_m = 0, alpha_f = 0, beta = 0.25, gamma = 0.5; ///< [1]
};

/// For a spectral radius at high frequency in 0 .. 1; throws ParameterError for another.
AlphaCoefficients generalised_alpha(double rho_inf);
/// For Newmark's two numbers; throws ParameterError for beta <= 0 or gamma < 1/2, which gain energy.
AlphaCoefficients newmark(double beta, double gamma);

class GeneralisedAlpha : public Stepper {
 public:
  /// The model must outlive the stepper.
  GeneralisedAlpha(ElasticModel& model, const AlphaCoefficients& coefficients, const NewtonOptions& options)
    : model_(model), c_(coefficients), solver_(model, options) {}

  StepReport step(State& state, const Loads& loads, double dt) override;

 private:
  Points first_acceleration(const State& state, const Loads& loads, double dt);
  Balance balance(const State& state, const Points& a, const Constraints& constraints, double dt) const;

  ElasticModel& model_;
  AlphaCoefficients c_;
  BalanceSolver solver_;
};

struct GeneralisedAlphaParameters {
  double rho_inf = 0.8; ///< [1]
  NewtonParameters newton = converged_newton();

  void describe(Parameters& p) {
    p.number("Spectral radius [1]", rho_inf, {.min = 0, .max = 1},
             "What a step leaves of vibrations that it does not resolve: 1 all, 0 nothing.");
    newton.describe(p);
  }
};

struct NewmarkParameters {
  double beta = 0.25, gamma = 0.5; ///< [1]
  NewtonParameters newton = converged_newton();

  void describe(Parameters& p) {
    p.number("Beta [1]", beta, positive, "1/4: average acceleration.");
    p.number("Gamma [1]", gamma, {.min = 0.5}, "1/2: second order and no damping; more damps.");
    newton.describe(p);
  }
};

} // namespace kerf::dynamics
