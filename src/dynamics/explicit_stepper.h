#pragma once

/// What explicit integrators have in common. They go from one state to another in passes over all corners: in large
/// bodies a step takes as long as memory does. What a corner takes and becomes is read and written once a pass: a few
/// at a time are moved, put where supports want them, and summed for those who watch the energy.
///
/// Forces of elements are found in a pass of their own. One for both, which moves corners as the first elements reach
/// them, takes up to 6 % longer than these two with up to 40,000 corners, and 3 to 13 % less from 100,000 on: elements
/// hardly wait for memory, and separate passes read it in its order.

#include "dynamics/conjugate_gradients.h"
#include "dynamics/constraints.h"
#include "dynamics/stable_step.h"
#include "dynamics/stepper.h"

#include <algorithm>

namespace kerf::dynamics {

class ExplicitStepper : public Stepper {
 public:
  StepReport step(State& state, const Loads& loads, double dt) final;
  Stepped step_from(const State& before, const Loads& loads, double dt, State& after) final;
  void archive(Archive& a) override { limit_.archive(a); }

 protected:
  /// The model must outlive the stepper.
  ExplicitStepper(ElasticModel& model, ExplicitScheme scheme, const ExplicitOptions& options)
    : model_(model), name_(scheme.name), limit_(model, scheme, options) {}

  struct Step {
    const State& before;
    const Loads& loads;
    const Constraints& constraints;
    std::span<const double> mass; ///< of each corner [kg]
    double dt;                    ///< [s]

    double end() const { return before.time + dt; }
  };
  /// Finds x and v, which have the right size, and sums both ends of the step.
  virtual SumsOfStep move(const Step& step, Points& x, Points& v) = 0;
  /// What acts beside gravity and mass damping [N]; good until it is asked again.
  const Points& force(const Loads& loads, const Moment& moment);

  /// Calls move(i) for each corner, and finish(begin, end, sum) for a few that were just moved.
  template <class Move, class Finish>
  static SumsOfStep pass(std::size_t n, const Move& move, const Finish& finish);
  /// What is held, where supports want it at a time, with their velocity.
  class Held {
   public:
    /// The step must outlive it.
    Held(const Step& step, double time);
    void put(std::size_t begin, std::size_t end, Points& x, Points& v) const;

   private:
    const Constraints& constraints_;
    Loan<Vec3> places_, velocities_;
  };

 private:
  ElasticModel& model_;
  std::string name_;
  StepLimit limit_;
  Points force_;
  State next_; // of step(): its memory
};

template <class Move, class Finish>
SumsOfStep ExplicitStepper::pass(const std::size_t n, const Move& move, const Finish& finish) {
  constexpr std::size_t few = 256; // corners that stay in the nearest cache
  return sum_in_blocks(n, SumsOfStep(), [&](const std::size_t begin, const std::size_t end, SumsOfStep& sum) {
    for (std::size_t first = begin; first < end; first += few) {
      const std::size_t last = std::min(first + few, end);
      for (std::size_t i = first; i < last; ++i)
        move(i);
      finish(first, last, sum);
    }
  });
}

} // namespace kerf::dynamics
