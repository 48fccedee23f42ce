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
/// A corner without mass follows (followers.h): the balance gives its place y where it holds, whatever its place
/// before. From there it goes on to the step's end as its leaders do. Extrapolated from the step's start as they are,
/// it would swing about y with the factor -alpha_f / (1 - alpha_f), for ever where rho_inf is 1.
///
/// State::history "acceleration" [m/s^2] is a_0. At the start the balance of forces gives it. Followers are
/// not in balance there yet: what pulls at them is given to their leaders, with the weights that lead them, so that
/// forces which keep the body's momentum still do. Where it was forgotten under way, as a cut has changed forces at
/// once, it is what the step resolves of that balance, with the stiffness K at x_0:
///
///     (M + beta dt^2 K) a_0 = f(x_0) + M g + loads.
///
/// A vibration of frequency w gets 1 / (1 + beta (w dt)^2) of its acceleration. Where the step resolves it, that is an
/// error of second order, whose power averages out over a period. Where it does not, M a_0 = f itself would throw what
/// the cut lets go at a distance d from its balance to the other side in the first step, with all its energy, for ever
/// at rho_inf = 1; so it comes to its balance in the first step, and keeps a velocity of 2 d / dt, in that step and,
/// times rho_inf in each, the next ones. That first step is one of average acceleration: any with alpha_f > 0 leaves
/// -alpha_f / (1 - alpha_f) of a distance that it does not resolve. Rannacher (1984, Finite element solution of
/// diffusion problems with irregular data, Numer. Math. 43) takes a few steps of implicit Euler after a jump: these
/// take energy from what is resolved too, and with a blade that cuts in every step there are no others.

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
    : model_(model),
      c_(coefficients),
      after_jump_(c_.alpha_f == 0 ? c_ : AlphaCoefficients()),
      solver_(model, options),
      first_(model, one_solution(options)) {}

  StepReport step(State& state, const Loads& loads, double dt) override;

 private:
  /// Newton's method of one correction, with a stiffness that is safe anywhere.
  static NewtonOptions one_solution(NewtonOptions options);
  Points first_acceleration(const State& state, const Loads& loads, double dt);
  /// Adds what it took to the report.
  Loan<Vec3> resolved_acceleration(const State& state, const Loads& loads, double dt, StepReport& report);
  Balance balance(const AlphaCoefficients& c, const State& state, const Points& a, const Constraints& constraints,
                  double dt) const;

  ElasticModel& model_;
  AlphaCoefficients c_, after_jump_; // of a step, and of the first one after a jump of forces
  BalanceSolver solver_, first_;
};

struct GeneralisedAlphaParameters {
  /// Cuts start vibrations that no step resolves: those of small pieces under strain changed their volume by a third
  /// and more where .8 of them was left in each step, and by a tenth with this.
  double rho_inf = 0.5; ///< [1]
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
