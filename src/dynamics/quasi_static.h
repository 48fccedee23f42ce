#pragma once

/// Statics: a step goes to the equilibrium of the loads and supports of its end, whatever inertia and damping would
/// say, by Newton's method with a line search (balance.h), whose corrections are mixed (mixing.h) unless the tangent is
/// the exact one.
///
/// When it does not converge, the way is divided: with r_0 the forces out of balance at the start and s from 0 to 1,
/// supports go the part s of their way and r = (1 - s) r_0 is solved, so that s = 0 is where the body stands. Forces
/// that need a velocity (friction, dampers, damping) are left out. Velocities at the end are zero.

#include "dynamics/newton_parameters.h"

namespace kerf::dynamics {

/// What to do about rigid motions that no support and no load resists.
enum class FreeModes {
  refuse, ///< with their names
  /// The model itself, or gravity on what hangs, resists them. Along translations, and with a law that sees rotations
  /// along all of them, the loads may have hardly anything out of balance (a tenth), and are relieved of it
  /// (FreeMotions).
  allow
};

struct QuasiStaticOptions {
  NewtonOptions newton{.max_iterations = 200,
                       .tolerance = 1e-7,
                       .line_search = LineSearch::backtracking,
                       .cg_tolerance = 1e-9,
                       .max_cg_iterations = 20000,
                       .n_mixed = 8};
  FreeModes free_modes = FreeModes::refuse;
  std::vector<std::uint32_t> piece = {}; ///< of each corner, 0, 1, ...; empty: one piece
};

struct QuasiStaticParameters {
  int n_newton = 200;
  double newton_tolerance = 1e-7; ///< [1]
  std::string solver = "conjugate gradients", tangent = "positive";
  double cg_tolerance = 1e-9; ///< [1]
  int max_cg_iterations = 20000;

  void describe(Parameters& p);
  QuasiStaticOptions options() const;
};

class QuasiStatic : public Stepper {
 public:
  /// The model must outlive the stepper.
  QuasiStatic(ElasticModel& model, const QuasiStaticOptions& options)
    : model_(model), options_(options), solver_(model, newton(options)) {}

  MotionKind motion() const override { return MotionKind::quasi_static; }
  /// Counts load steps as substeps. Throws ParameterError for free rigid motions, NumericalError for loads along them
  /// that are not in balance, and when the smallest load step (1/1024) does not converge.
  StepReport step(State& state, const Loads& loads, double dt) override;

 private:
  static NewtonOptions newton(const QuasiStaticOptions& options);
  /// The rigid motions along which nothing but the loads' own balance decides. Throws NumericalError without it.
  FreeMotions balanced_motions(const Loads& loads, double time, State& state);
  bool sees_rotations(const Points& rest) const;
  Points out_of_balance(const Loads& loads, double time, const Points& x);

  ElasticModel& model_;
  QuasiStaticOptions options_;
  BalanceSolver solver_;
};

} // namespace kerf::dynamics
