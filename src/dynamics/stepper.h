#pragma once

#include "dynamics/loads.h"
#include "dynamics/mass_sums.h"
#include "dynamics/state.h"

#include <optional>

namespace kerf::dynamics {

/// Of vibration (modal.h); nothing of other steppers.
struct Modes {
  std::vector<double> frequencies = {}; ///< ascending [Hz]
  std::vector<Points> shapes = {};      ///< displacement of each particle, the largest of a mode 1 [1]

  void archive(Archive& a) { a(frequencies, shapes); }
};

/// What a step took; 0 where a stepper has no such thing.
struct StepReport {
  int n_iterations = 0;   ///< of the linear solver, summed over the step
  int n_newton = 0;       ///< iterations of Newton's method, summed over the step
  int n_substeps = 0;     ///< time steps or load steps inside this one, if it was divided
  int n_rejected = 0;     ///< of them tried and thrown away
  double stable_step = 0; ///< of an explicit integrator when it was computed last [s]
  double residual = 0;    ///< forces out of balance at the end over the forces that balance, if it was measured [1]

  bool begins_anew = false; ///< the forces where it began had no say: they had jumped

  Modes modes = {};

  void archive(Archive& a) {
    a(n_iterations, n_newton, n_substeps, n_rejected, stable_step, residual, begins_anew, modes);
  }
};

/// A step from one state to another.
struct Stepped {
  StepReport report;
  std::optional<SumsOfStep> sums = {}; ///< where they were found on the way
};

/// What a stepper makes of inertia.
enum class MotionKind { dynamic, quasi_static };

/// All that the main loop knows of a physics.
class Stepper {
 public:
  virtual ~Stepper() = default;

  /// Advances the state by dt [s]. Throws NumericalError when it cannot, and then leaves the state as it was.
  virtual StepReport step(State& state, const Loads& loads, double dt) = 0;
  /// The same to another state, in the memory that this one has: `before` stays.
  virtual Stepped step_from(const State& before, const Loads& loads, const double dt, State& after) {
    assign(after, before);
    return {step(after, loads, dt)};
  }
  virtual MotionKind motion() const { return MotionKind::dynamic; }
  /// What it knows beside the state, and would not find again by itself.
  virtual void archive(Archive&) {}
};

} // namespace kerf::dynamics
