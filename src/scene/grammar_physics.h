#pragma once

/// What a scene may say of a body's physics: backends, integrators, and their settings.

#include "dynamics/adaptive.h"
#include "dynamics/generalised_alpha.h"
#include "dynamics/modal.h"
#include "dynamics/quasi_static.h"
#include "dynamics/stable_step.h"
#include "scene/text_grammar.h"

namespace kerf::scene {

const std::vector<std::string>& backend_names();
const std::vector<std::string>& integrator_names();
/// Those of them that solve equations for the end of each step, and have dynamics::NewtonParameters.
const std::vector<std::string>& implicit_integrator_names();

/// Those that take a step from forces alone, no longer than their stable one.
bool is_explicit(const std::string& integrator);

/// Newton's method for BDF2.
struct ConvergedNewtonParameters {
  dynamics::NewtonParameters newton = dynamics::converged_newton();
  void describe(Parameters& p) { newton.describe(p); }
};

struct QuasiStaticSceneParameters {
  dynamics::QuasiStaticParameters statics;
  std::string free_modes = "refuse";

  void describe(Parameters& p) {
    statics.describe(p);
    p.choice("Free modes", free_modes, {"refuse", "allow"},
             "What to do about rigid motions of a piece that no support and no load resists: name them and stop, or "
             "leave it to the solver. Loads along free translations (with small strain, along free rotations too) must "
             "then be in balance to a tenth; what is left of them accelerates the body as a whole, and does not deform "
             "it.");
  }
};

/// Lattice shape matching. Its stiffness is that of the material unless alpha is written.
struct LatticeParameters {
  int half_width = 2;
  double alpha = 0;          ///< [1]; 0: from Young's modulus
  double region_damping = 0; ///< [1/s]
  void describe(Parameters& p);
};

/// The sections of integrators and backends, which stand in a body.
std::vector<SectionKind> physics_kinds();

} // namespace kerf::scene
