#pragma once

/// Vibration: the lowest modes K u = (2 pi f)^2 M u of a body as it stands at the start of a step, among the directions
/// that supports leave free. K is the model's stiffness there and that of the loads (handles, skins that are held);
/// gravity and damping have no part.
///
/// Lanczos' method by ARPACK (deal.II's ArpackSolver) on (K + s M)^-1 M, whose largest eigenvalues are those of the
/// lowest modes; s is far below the square of the first frequency, and makes the equation regular for a body that
/// floats, whose rigid motions have the frequency 0. An equation is solved by conjugate gradients with the model's
/// preconditioner. One start sees one mode of several with the same frequency, so what was found is taken out and
/// sought in again, until nothing is found below the highest that is wanted.

#include "base/parameters.h"
#include "dynamics/model.h"
#include "dynamics/stepper.h"

namespace kerf::dynamics {

struct ModalParameters {
  int n_modes = 6;
  double cg_tolerance = 1e-10; ///< [1]
  int max_cg_iterations = 20000;

  void describe(Parameters& p);
};

/// The lowest modes, by ascending frequency. Throws ParameterError where the body has no more directions to move in
/// than modes are wanted, NumericalError where equations or modes are not found.
Modes lowest_modes(ElasticModel& model, const Loads& loads, double time, const Points& x,
                   const ModalParameters& parameters, int& n_iterations);

/// A step finds the modes, and leaves the body where it is.
class Modal : public Stepper {
 public:
  /// The model must outlive the stepper.
  Modal(ElasticModel& model, const ModalParameters& parameters) : model_(model), parameters_(parameters) {}

  MotionKind motion() const override { return MotionKind::quasi_static; }
  StepReport step(State& state, const Loads& loads, double dt) override;

 private:
  ElasticModel& model_;
  ModalParameters parameters_;
};

} // namespace kerf::dynamics
