#include "scene/grammar_physics.h"

#include "physics/phyxels.h"

#include <algorithm>

namespace kerf::scene {

const std::vector<std::string>& backend_names() {
  static const std::vector<std::string> names = {"fem", "pba", "lattice", "mass-spring"};
  return names;
}

const std::vector<std::string>& integrator_names() {
  static const std::vector<std::string> names = {"implicit Euler",
                                                 "BDF2",
                                                 "Newmark",
                                                 "generalised alpha",
                                                 "quasi-static",
                                                 "symplectic Euler",
                                                 "velocity Verlet",
                                                 "explicit Euler",
                                                 "midpoint Runge-Kutta",
                                                 "modal"};
  return names;
}

const std::vector<std::string>& implicit_integrator_names() {
  static const std::vector<std::string> names = {"implicit Euler", "BDF2", "Newmark", "generalised alpha"};
  return names;
}

bool is_explicit(const std::string& integrator) {
  static const std::vector<std::string> names = {"symplectic Euler", "velocity Verlet", "explicit Euler",
                                                 "midpoint Runge-Kutta"};
  return std::find(names.begin(), names.end(), integrator) != names.end();
}

void LatticeParameters::describe(Parameters& p) {
  p.integer("Half width [cells]", half_width, {.min = 1, .max = 1e6},
            "Of the regions that are matched; wider ones are stiffer and cost the same.");
  p.number("Alpha [1]", alpha, {.min = 0, .max = 1},
           "Part of the way to its goal that a corner is sent in a step. 0: by Young's modulus of the material.");
  p.number("Region damping [1/s]", region_damping, non_negative,
           "Rate at which velocities turn to the regions' rigid motions.");
}

std::vector<SectionKind> physics_kinds() {
  const std::string settings = "Settings of that integrator.";
  return {
    {"Implicit Euler", Occurrence::once, settings, keys_of<dynamics::NewtonParameters>(), {}},
    {"BDF2", Occurrence::once, settings, keys_of<ConvergedNewtonParameters>(), {}},
    {"Newmark", Occurrence::once, settings, keys_of<dynamics::NewmarkParameters>(), {}},
    {"Generalised alpha", Occurrence::once, settings, keys_of<dynamics::GeneralisedAlphaParameters>(), {}},
    {"Quasi-static", Occurrence::once, settings, keys_of<QuasiStaticSceneParameters>(), {}},
    {"Modal", Occurrence::once, settings, keys_of<dynamics::ModalParameters>(), {}},
    {"Symplectic Euler", Occurrence::once, settings, keys_of<dynamics::ExplicitParameters>(), {}},
    {"Velocity Verlet", Occurrence::once, settings, keys_of<dynamics::ExplicitParameters>(), {}},
    {"Explicit Euler", Occurrence::once, settings, keys_of<dynamics::ExplicitParameters>(), {}},
    {"Midpoint Runge-Kutta", Occurrence::once, settings, keys_of<dynamics::ExplicitParameters>(), {}},
    {"Adaptive step",
     Occurrence::once,
     "Divides the steps of an implicit integrator until their error is small. Without this section steps are whole.",
     keys_of<dynamics::AdaptiveParameters>(),
     {}},
    {"Phyxels",
     Occurrence::once,
     "Backend pba: samples of the body and their model.",
     keys_of<pba::PhyxelOptions, pba::ModelOptions>(),
     {}},
    {"Visibility",
     Occurrence::once,
     "Backend pba: what a cut leaves of the weight of two points.",
     keys_of<physics::VisibilityOptions>(),
     {}},
    {"Lattice", Occurrence::once, "Backend lattice: shape matching.", keys_of<LatticeParameters>(), {}},
  };
}

} // namespace kerf::scene
