#pragma once

/// Steps of any integrator whose energy is accounted for.
///
/// A step adds, in what nobody did: the growth of kinetic, elastic, gravity and load energy, less the work of supports,
/// of driving loads and of potentials that change with time. Work is force times displacement with the forces of the
/// start or of the end, whichever is more. A sound step gains at most a part of the energy that it deals with: what
/// moves against its piece's mean motion and what is elastic, before and after, and the work; beside the kick that
/// gravity gives in one step, which first order shifts in time, and round-off. Implicit Euler gains where energy is
/// concave along its way, of second order in dt; symplectic integrators take and give it back, up to a multiple near
/// their stable step, and are to be allowed more. Dissipation, the integrator's own too, counts as it should.
///
/// Two things are done about a step that fails, gains energy or is no longer finite. It is taken again in 2, 4, ...
/// substeps, which remove any error of second order. A method that takes energy and gives none is held to less
/// (SoundOptions::wanted_gain); steps of it that gain more, as Newton's method has not come to an end, are tried again
/// in 2 and 4 substeps, of which the first that gains no more is taken, or else what gained least. And an integrator
/// that gains a little in each step is watched by the sum (Page 1954, Continuous inspection schemes, Biometrika 41: S =
/// max(0, S + gain)): once a part of all kinetic and elastic energy is gained that way, half where nothing else is
/// said, the motion is no more the body's.
///
/// An integrator that takes no energy may have another for the last resort, which does: a step that nothing mends is
/// then taken by that one, and the next starts anew.
///
/// State::numbers "energy gained [J]" is that sum.

#include "base/error.h"
#include "dynamics/loads.h"
#include "dynamics/pieces.h"
#include "dynamics/stepper.h"

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>

namespace kerf::dynamics {

/// A step that cannot be mended, and the particle where it shows most.
class StepError : public NumericalError {
 public:
  StepError(const std::string& message, const std::size_t particle) : NumericalError(message), particle_(particle) {}
  std::size_t particle() const { return particle_; }

 private:
  std::size_t particle_;
};

struct SoundOptions {
  int most_substeps = 64;  ///< a power of 2; 1: no step is taken again
  double most_gain = 0.25; ///< in a step, of the energy that it deals with [1]
  double most_sum = 0.5;   ///< of what steps gained, over all kinetic and elastic energy [1]
  double kick = 1;         ///< part that is granted of what first order may misplace of gravity in a step [1]
  /// The same, above which a step is better taken in substeps; gravity's kick is not granted. Infinity: no such limit
  /// [1].
  double wanted_gain = std::numeric_limits<double>::infinity();
  bool each_piece = false; ///< each piece that flies is held to most_gain by itself (piece_gains.h)
};

/// Elastic energies of the two states that were asked for last: a step that is accepted ends where the next one starts,
/// and one that is taken again starts where it did. Knows positions alone, so a model that changes needs another one.
class ElasticEnergies {
 public:
  explicit ElasticEnergies(const ForceModel& model) : model_(model) {}

  double at(const Points& x); ///< [J]

 private:
  struct Known {
    std::optional<std::uint64_t> where = {}; ///< fingerprint of the positions
    double energy = 0;
  };

  const ForceModel& model_;
  std::array<Known, 2> known_; ///< the later asked for comes first
};

/// Round-off of the elastic energy, by what it costs to grow by a thousandth [J]; and of many steps together.
double noise_of_energy(const ForceModel& model, const Points& x);
double noise_of_steps(const ForceModel& model, const Points& x);

class SoundSteps : public Stepper {
 public:
  /// The model must outlive the stepper, and stay as it is: after a cut both are made again.
  SoundSteps(ForceModel& model, Pieces pieces, std::unique_ptr<Stepper> stepper, const SoundOptions& options,
             std::unique_ptr<Stepper> last_resort = nullptr)
    : model_(model),
      pieces_(std::move(pieces)),
      stepper_(std::move(stepper)),
      last_resort_(std::move(last_resort)),
      options_(options),
      energies_(model) {}

  /// Counts substeps where there are several, and steps tried and thrown away. Throws StepError when the shortest
  /// substeps fail too, with the reason of the whole step.
  StepReport step(State& state, const Loads& loads, double dt) override;

  void archive(Archive& a) override {
    stepper_->archive(a);
    if (last_resort_)
      last_resort_->archive(a);
  }
  const Stepper& watched() const { return *stepper_; }

 private:
  /// A state in memory that is used again.
  struct GiveBack {
    SoundSteps* owner;
    void operator()(State* const state) const { owner->idle_.emplace_back(state); }
  };
  using LentState = std::unique_ptr<State, GiveBack>;

  struct Tried {
    StepReport report;
    LentState state; ///< null until there is one
    bool is_as_wanted = true;
    double gained = 0; ///< in substeps that gained [J]
  };

  LentState lend();
  /// From a state, all in `n` substeps.
  Tried divided(const State& state, const Loads& loads, double dt, int n);
  /// One substep more from `state`, which may be that of `tried`.
  void add_checked(const State& state, const Loads& loads, double dt, Tried& tried);
  StepReport by_last_resort(State& state, const Loads& loads, double dt);

  ForceModel& model_;
  Pieces pieces_;
  std::unique_ptr<Stepper> stepper_, last_resort_;
  SoundOptions options_;
  ElasticEnergies energies_;
  std::vector<std::unique_ptr<State>> idle_;
};

/// Numbers in messages, with three digits.
std::string in_short(double value);
std::string per_cent(double part);

} // namespace kerf::dynamics
