#include "scene/compose_integrator.h"

#include "dynamics/bdf2.h"
#include "dynamics/explicit_steppers.h"
#include "dynamics/implicit_euler.h"
#include "dynamics/sound_steps.h"
#include "dynamics/symplectic_euler.h"
#include "scene/grammar_physics.h"

namespace kerf::scene {

namespace {

using dynamics::ElasticModel;
using physics::PiecesOfParticles;
using Stepper = std::unique_ptr<dynamics::Stepper>;

struct Implicit {
  Integrator integrator;
  int order; ///< of its error
};

/// A fifth of the 1 % to which an energy book may stay open.
constexpr dynamics::SoundOptions dissipative{.kick = 0.01, .wanted_gain = 2e-3};
/// Of 20 steps of a soft body that bends far, and that 16 substeps did not mend, 32 or 64 mended 7, at three times the
/// cost of all tries before.
constexpr dynamics::SoundOptions conservative{
  .most_substeps = 16, .most_gain = 0.05, .most_sum = 0.1, .kick = 0, .wanted_gain = 1e-2, .each_piece = true};
constexpr dynamics::SoundOptions as_they_are{.most_substeps = 1};
/// Near its stable step an explicit integrator takes and gives back more than a quarter.
constexpr dynamics::SoundOptions explicit_ones{.most_gain = 0.75},
  explicit_as_they_are{.most_substeps = 1, .most_gain = 0.75};

/// Watches the energy of an integrator's steps, and divides those that gain some.
physics::StepperMaker sound(const physics::StepperMaker& make, const dynamics::SoundOptions& options) {
  return [=](ElasticModel& model, const PiecesOfParticles& pieces) -> Stepper {
    return std::make_unique<dynamics::SoundSteps>(model, dynamics::Pieces(pieces()), make(model, pieces), options);
  };
}

/// Implicit Euler whose corrections are tested piece by piece.
Stepper implicit_euler(ElasticModel& model, const dynamics::NewtonParameters& parameters,
                       const PiecesOfParticles& pieces) {
  auto options = dynamics::implicit_euler_options(parameters);
  options.piece = pieces();
  return std::make_unique<dynamics::ImplicitEuler>(model, options);
}

/// Watched as `options` say; what cannot be mended is a step of implicit Euler with these parameters.
physics::StepperMaker sound_or_implicit_euler(const physics::StepperMaker& make, const dynamics::SoundOptions& options,
                                              const dynamics::NewtonParameters& parameters) {
  return [=](ElasticModel& model, const PiecesOfParticles& pieces) -> Stepper {
    auto last_resort = std::make_unique<dynamics::SoundSteps>(
      model, dynamics::Pieces(pieces()), implicit_euler(model, parameters, pieces), dissipative);
    return std::make_unique<dynamics::SoundSteps>(model, dynamics::Pieces(pieces()), make(model, pieces), options,
                                                  std::move(last_resort));
  };
}

/// `make` gets the model, the integrator's own settings, and the pieces.
template <class Fields, class Make>
Implicit implicit(const Section& body, const std::string& section, const int order, const Make& make) {
  const auto parameters = read_if_written<Fields>(body, section);
  return {
    {[=](ElasticModel& model, const PiecesOfParticles& pieces) -> Stepper { return make(model, parameters, pieces); }},
    order};
}

template <class Explicit>
Integrator explicit_integrator(const Section& body, const std::string& section) {
  const auto options = read_if_written<dynamics::ExplicitParameters>(body, section).options();
  const auto make = [=](ElasticModel& model, const PiecesOfParticles&) -> Stepper {
    return std::make_unique<Explicit>(model, options);
  };
  const bool is_divided = options.beyond == dynamics::BeyondStable::refuse;
  return {sound(make, is_divided ? explicit_ones : explicit_as_they_are), fem::Inertia::extended};
}

Integrator quasi_static(const Section& body) {
  const auto parameters = read_if_written<QuasiStaticSceneParameters>(body, "Quasi-static");
  auto options = parameters.statics.options();
  options.free_modes = parameters.free_modes == "allow" ? dynamics::FreeModes::allow : dynamics::FreeModes::refuse;
  return {[=](ElasticModel& model, const PiecesOfParticles& pieces) {
    auto with_pieces = options;
    with_pieces.piece = pieces();
    return std::make_unique<dynamics::QuasiStatic>(model, with_pieces);
  }};
}

Integrator modal(const Section& body) {
  const auto parameters = read_if_written<dynamics::ModalParameters>(body, "Modal");
  return {[=](ElasticModel& model, const PiecesOfParticles&) {
    return std::make_unique<dynamics::Modal>(model, parameters);
  }};
}

/// Nothing damps what rings: corners of hardly any mass have none, and follow the others.
Implicit undamped(Implicit implicit) {
  implicit.integrator.inertia = fem::Inertia::gathered;
  return implicit;
}

Implicit implicit_integrator(const Section& body, const std::string& name) {
  using dynamics::GeneralisedAlpha;
  if (name == "BDF2")
    return undamped(implicit<ConvergedNewtonParameters>(
      body, "BDF2", 2, [](ElasticModel& model, const ConvergedNewtonParameters& p, const PiecesOfParticles&) {
        return std::make_unique<dynamics::Bdf2>(model, p.newton.options());
      }));
  if (name == "Newmark")
    return undamped(implicit<dynamics::NewmarkParameters>(
      body, "Newmark", 2, [](ElasticModel& model, const dynamics::NewmarkParameters& p, const PiecesOfParticles&) {
        return std::make_unique<GeneralisedAlpha>(model, dynamics::newmark(p.beta, p.gamma), p.newton.options());
      }));
  if (name == "generalised alpha")
    return undamped(implicit<dynamics::GeneralisedAlphaParameters>(
      body, "Generalised alpha", 2,
      [](ElasticModel& model, const dynamics::GeneralisedAlphaParameters& p, const PiecesOfParticles&) {
        return std::make_unique<GeneralisedAlpha>(model, dynamics::generalised_alpha(p.rho_inf), p.newton.options());
      }));
  return implicit<dynamics::NewtonParameters>(body, "Implicit Euler", 1, implicit_euler);
}

Integrator with_adaptive_step(const Section& body, const Implicit& implicit) {
  if (!body.find("Adaptive step")) {
    Integrator divided = implicit.integrator;
    constexpr int of_implicit_euler = 1;
    divided.make =
      implicit.order == of_implicit_euler // one correction a step may not do where a few points hold a body
        ? sound_or_implicit_euler(implicit.integrator.make, dissipative, dynamics::converged_newton())
        : sound_or_implicit_euler(implicit.integrator.make, conservative, {});
    return divided;
  }
  const auto parameters = read_if_written<dynamics::AdaptiveParameters>(body, "Adaptive step");
  Integrator adaptive = implicit.integrator;
  adaptive.make = [=](ElasticModel& model, const PiecesOfParticles& pieces) {
    return std::make_unique<dynamics::AdaptiveStepper>(
      model, sound(implicit.integrator.make, as_they_are)(model, pieces), implicit.order, parameters);
  };
  return adaptive;
}

} // namespace

Integrator compose_integrator(const Section& body, const std::string& name) {
  if (name == "quasi-static")
    return quasi_static(body);
  if (name == "modal")
    return modal(body);
  if (name == "symplectic Euler")
    return explicit_integrator<dynamics::SymplecticEuler>(body, "Symplectic Euler");
  if (name == "velocity Verlet")
    return explicit_integrator<dynamics::VelocityVerlet>(body, "Velocity Verlet");
  if (name == "explicit Euler")
    return explicit_integrator<dynamics::ExplicitEuler>(body, "Explicit Euler");
  if (name == "midpoint Runge-Kutta")
    return explicit_integrator<dynamics::MidpointRungeKutta>(body, "Midpoint Runge-Kutta");
  return with_adaptive_step(body, implicit_integrator(body, name));
}

} // namespace kerf::scene
