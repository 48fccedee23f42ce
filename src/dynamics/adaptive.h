#pragma once

/// A step of any integrator, divided until its error is small enough.
///
/// Each substep of length h is done once as a whole and once as two halves, from the same state. Their difference e
/// is 2^p - 1 times the error of the halves for a one-step integrator of order p (Hairer, Norsett, Wanner, Solving
/// ODEs I, II.4), and 1.7 times for BDF2, whose whole and halves meet different ratios of steps: e itself bounds
/// both. The halves are kept when |e_x| + dt |e_v| <= tolerance h for every corner, with the step dt for a time
/// scale. What a corner of less than the mean mass m errs by counts m_i / m times, as in the momentum of the error:
/// where near-empty cubes alone know a corner, a cut and what solvers leave throw it most, its own motion is faster
/// than any step, and it means least to the others. A substep below dt / 1000 whose error does not fall with h has met
/// a jump of a force and is kept too. The next substep is 0.9 (tolerance h / error)^(1/p) times as long, within
/// 1/4 .. 1.2 (BDF2 goes no further in one). It costs three solutions a substep kept.
///
/// Generalised alpha below rho_inf = 1 remembers an acceleration whose time depends on the step, and pays for each
/// change of it with an error of first order: Newmark and BDF2 need fewer substeps for small tolerances.
///
/// State::numbers "substep [s]" is the length that comes next.

#include "base/parameters.h"
#include "dynamics/model.h"
#include "dynamics/stepper.h"

#include <memory>

namespace kerf::dynamics {

struct AdaptiveParameters {
  double tolerance = 1e-3; ///< [m/s]
  double shortest = 1e-8;  ///< [s]

  void describe(Parameters& p) {
    p.number("Error tolerance [m/s]", tolerance, positive,
             "What a corner's position, and its velocity times the time step, may be wrong by for each second.");
    p.number("Shortest substep [s]", shortest, positive, "A step that needs a shorter one is given up.");
  }
};

class AdaptiveStepper : public Stepper {
 public:
  /// `order` of the stepper [1]. The model must outlive it.
  AdaptiveStepper(const ForceModel& model, std::unique_ptr<Stepper> stepper, int order,
                  const AdaptiveParameters& parameters)
    : model_(model), stepper_(std::move(stepper)), order_(order), parameters_(parameters) {}

  /// Counts substeps kept and thrown away. Throws NumericalError when substeps become too short.
  StepReport step(State& state, const Loads& loads, double dt) override;
  void archive(Archive& a) override { stepper_->archive(a); }

 private:
  /// Two halves of a substep in `state`; returns their error over what is allowed, infinite when a solution failed.
  double try_substep(State& state, const Loads& loads, double h, double dt, StepReport& report);

  const ForceModel& model_;
  std::unique_ptr<Stepper> stepper_;
  int order_;
  AdaptiveParameters parameters_;
};

} // namespace kerf::dynamics
