#pragma once

/// The longest time step that an explicit integrator bears.
///
/// The largest eigenvalue w^2 of M^-1 K, K the tangent of model and loads at a state, and the largest d of M^-1 C, C
/// that of the loads by velocities, come from Lanczos' method from a fixed start, which is power iteration that
/// forgets nothing (Golub and Van Loan, Matrix Computations, 10.1). A vibration of frequency w under mass damping
/// alpha and stiffness damping beta goes through a step by a 2 x 2 matrix that is the integrator's own; the stable
/// step is the longest for which no frequency up to w grows by more than the integrator's allowance.

#include "base/parameters.h"
#include "dynamics/loads.h"
#include "dynamics/state.h"

#include <Eigen/Core>

#include <string>

namespace kerf::dynamics {

/// One vibration: x'' = -square x - (mass_damping + other_damping) x'.
struct Mode {
  double square = 0;        ///< w^2 [1/s^2]
  double mass_damping = 0;  ///< alpha [1/s]
  double other_damping = 0; ///< beta w^2 + d [1/s]
};

/// What an integrator makes of (x, v) of a mode in a step dt [s].
using Amplification = Eigen::Matrix2d (*)(const Mode& mode, double dt);

/// Largest w^2 [1/s^2] at the state, held components left out, to 0.1 %.
double largest_square_frequency(ElasticModel& model, const Loads& loads, const State& state);
/// Largest d [1/s] of the loads' own damping, but for what is bounded.
double largest_load_damping(const ForceModel& model, const Loads& loads, const State& state);

/// At least the largest w^2 that the loads' stiffness gives to the masses by itself, where these hang on nothing else
/// [1/s^2]; cheap.
double load_square_bound(const ForceModel& model, const Loads& loads, const State& state);

/// Longest step [s] for which the spectral radius of a mode and of all slower ones is at most 1 + allowance; infinite
/// for a mode without frequency and damping.
double stable_step(Amplification amplification, const Mode& fastest, double stiffness_damping, double allowance);

enum class BeyondStable { refuse, go_on };

struct ExplicitOptions {
  BeyondStable beyond = BeyondStable::refuse;
};

struct ExplicitParameters {
  std::string beyond = "refuse";

  void describe(Parameters& p) {
    p.choice("Beyond the stable step", beyond, {"refuse", "go on"},
             "What to do with a time step that is longer than this integrator bears.");
  }
  ExplicitOptions options() const { return {beyond == "go on" ? BeyondStable::go_on : BeyondStable::refuse}; }
};

/// What an explicit integrator is to the stable step.
struct ExplicitScheme {
  std::string name;
  Amplification amplification;
  /// Growth a step that passes for stable [1]. Explicit Euler and midpoint Runge-Kutta let any undamped vibration grow;
  /// theirs is 1e-3.
  double allowance;
};

/// Watches an integrator's steps: computes its stable step at the first one, whenever a longer one is asked for, and when
/// loads become stiffer, as a body lands. After a cut, for which integrators are made again, it does so at once where
/// steps are longer than .75 of what the state remembers as the stable one, else no more than once in 200 steps: that
/// costs as much as some 15 steps. Cuts shorten the stable step by a fifth at most as a rule; if it is more, that shows by
/// what steps gain (sound_steps.h).
///
/// A step that is too long from the start is a mistake in the scene; one that has become too long may be divided.
class StepLimit {
 public:
  StepLimit(ElasticModel& model, const ExplicitScheme& scheme, const ExplicitOptions& options)
    : model_(model),
      scheme_(scheme),
      options_(options),
      known_("stable step of " + scheme.name + " [s]"),
      steps_since_("steps since the stable step of " + scheme.name + " was found [1]"),
      load_("square frequency of loads with the stable step of " + scheme.name + " [1/s^2]") {}

  /// Where beyond is refused, and dt is: throws ParameterError with the stable step at the first step of a state, and
  /// NumericalError later. `numbers`: State::numbers, of this state or of what comes of it.
  void require(const State& state, const Loads& loads, double dt, std::map<std::string, double>& numbers);
  /// The stable step when it was computed last [s]; 0: never.
  double last() const { return last_; }
  void archive(Archive& a) { a(longest_checked_, last_, load_found_, n_since_found_); }
  /// At a state [s].
  double at(const State& state, const Loads& loads) const;

 private:
  void require_stable(double dt, bool is_first);

  ElasticModel& model_;
  ExplicitScheme scheme_;
  ExplicitOptions options_;
  std::string known_, steps_since_, load_; // names in State::numbers
  double longest_checked_ = 0, last_ = 0;  // [s]
  double load_found_ = 0;                  // load_square_bound() with last_, where it was found [1/s^2]
  int n_since_found_ = -1;                 // steps that were asked about since it found its own one; -1: never
};

} // namespace kerf::dynamics
