#pragma once

/// All integrators by name, as accurate as they can be.

#include "dynamics/bdf2.h"
#include "dynamics/explicit_steppers.h"
#include "dynamics/generalised_alpha.h"
#include "dynamics/implicit_euler.h"
#include "dynamics/symplectic_euler.h"

#include <functional>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

namespace kerf::dynamics {

struct Integrator {
  std::string name;
  int order;
  std::function<std::unique_ptr<Stepper>(ElasticModel&)> make;
};

inline const NewtonOptions exact_newton{.max_iterations = 20, .tolerance = 1e-13, .cg_tolerance = 1e-14};
inline constexpr ExplicitOptions go_on{BeyondStable::go_on};

inline void PrintTo(const Integrator& integrator, std::ostream* out) { *out << integrator.name; }

template <class S, class Options>
std::unique_ptr<Stepper> made(ElasticModel& model, const Options& options) {
  return std::make_unique<S>(model, options);
}

inline std::unique_ptr<Stepper> made_alpha(ElasticModel& model, const AlphaCoefficients& coefficients) {
  return std::make_unique<GeneralisedAlpha>(model, coefficients, exact_newton);
}

inline const std::vector<Integrator>& integrators() {
  static const std::vector<Integrator> all = {
    {"explicit_Euler", 1, [](ElasticModel& m) { return made<ExplicitEuler>(m, go_on); }},
    {"symplectic_Euler", 1, [](ElasticModel& m) { return made<SymplecticEuler>(m, go_on); }},
    {"midpoint", 2, [](ElasticModel& m) { return made<MidpointRungeKutta>(m, go_on); }},
    {"velocity_Verlet", 2, [](ElasticModel& m) { return made<VelocityVerlet>(m, go_on); }},
    {"implicit_Euler", 1,
     [](ElasticModel& m) {
       return made<ImplicitEuler>(
         m, ImplicitEulerOptions{.n_newton = 20, .cg_tolerance = 1e-14, .newton_tolerance = 1e-13});
     }},
    {"Newmark", 2, [](ElasticModel& m) { return made_alpha(m, newmark(0.25, 0.5)); }},
    {"damped_Newmark", 1, [](ElasticModel& m) { return made_alpha(m, newmark(0.36, 0.7)); }},
    {"generalised_alpha_1", 2, [](ElasticModel& m) { return made_alpha(m, generalised_alpha(1)); }},
    {"generalised_alpha_half", 2, [](ElasticModel& m) { return made_alpha(m, generalised_alpha(0.5)); }},
    {"generalised_alpha_0", 2, [](ElasticModel& m) { return made_alpha(m, generalised_alpha(0)); }},
    {"BDF2", 2, [](ElasticModel& m) { return made<Bdf2>(m, exact_newton); }},
  };
  return all;
}

} // namespace kerf::dynamics
