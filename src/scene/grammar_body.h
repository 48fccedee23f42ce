#pragma once

/// What a scene may say of a body: its mesh, grid, material, damping, integrator, supports.

#include "scene/text_grammar.h"

#include <string>
#include <vector>

namespace kerf::scene {

struct BodyParameters {
  std::string mesh;
  double mesh_unit = 1;                      ///< [m]
  double cube_edge = 0.01;                   ///< [m]
  Vec3 lattice_offset = Vec3::Constant(0.5); ///< parts of a cube edge [1]
  double sharp_angle = 45;                   ///< [degrees]
  std::string integration = "octants";
  std::string element = "trilinear";
  std::string integrator = "implicit Euler";
  void describe(Parameters& p);
};

struct DampingParameters {
  double mass = 0;      ///< [1/s]
  double stiffness = 0; ///< [s]
  void describe(Parameters& p);
};

struct ImplicitEulerParameters {
  int n_newton = 1;
  double cg_tolerance = 1e-6;
  int max_cg_iterations = 2000;
  double sliver_floor = 1e-3; ///< [1]
  void describe(Parameters& p);
};

struct SymplecticEulerParameters {
  double mass_spread = 0.2; ///< [1]
  void describe(Parameters& p);
};

struct SupportParameters {
  Vec3 lower = Vec3::Zero(), upper = Vec3::Zero(); ///< [m]
  std::string displacement = "0; 0; 0";
  void describe(Parameters& p);
};

/// The section `Body` with all that stands in it.
std::vector<SectionKind> body_kinds();

} // namespace kerf::scene
