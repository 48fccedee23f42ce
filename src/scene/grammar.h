#pragma once

/// What a scene may say: the parameters that belong to no module below, and the tree of sections.

#include "scene/text_grammar.h"

#include <string>
#include <vector>

namespace kerf::scene {

struct TimeParameters {
  double time_step = 1.0 / 60; ///< [s]
  double end_time = 1;         ///< [s]
  void describe(Parameters& p);
};

struct GravityParameters {
  Vec3 acceleration = {0, 0, -9.81}; ///< [m/s^2]
  void describe(Parameters& p);
};

struct BodyParameters {
  std::string mesh;
  double mesh_unit = 1;                      ///< [m]
  double cube_edge = 0.01;                   ///< [m]
  Vec3 lattice_offset = Vec3::Constant(0.5); ///< parts of a cube edge [1]
  double sharp_angle = 45;                   ///< [degrees]
  std::string integration = "octants";
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

struct BladeParameters {
  Points edge;               ///< blade frame [m]
  Vec3 spine = Vec3::Zero(); ///< blade frame [m]
  std::vector<double> times; ///< [s]
  Points positions;          ///< [m]
  Points rotations;          ///< [degrees]
  void describe(Parameters& p);
};

struct CutSurfaceParameters {
  double time = 0; ///< [s]
  std::string shape;
  void describe(Parameters& p);
};

/// What places a cut surface. Describes the keys of `shape`, all of which must be set but the last one of a mesh;
/// those of all shapes while it is empty.
struct ShapeParameters {
  std::string shape;
  Vec3 point = Vec3::Zero();                         ///< [m]
  Vec3 normal = Vec3::UnitZ(), axis = Vec3::UnitZ(); ///< any length [1]
  double radius = 0.01, height = 0.01;               ///< [m]
  std::string mesh;
  double mesh_unit = 1; ///< [m]
  void describe(Parameters& p);
};

struct OutputParameters {
  int frames_every = 10; ///< steps
  void describe(Parameters& p);
};

struct SurfaceFileParameters {
  int every = 2; ///< steps
  void describe(Parameters& p);
};

struct ObservableParameters {
  std::string names;
  void describe(Parameters& p);
};

struct ImageParameters {
  int every = 2; ///< steps
  int width = 960, height = 720;
  Vec3 eye = {0, -1, 0.5}, target = Vec3::Zero(), up = Vec3::UnitZ(); ///< [m]
  double field_of_view = 35;                                          ///< [degrees]
  void describe(Parameters& p);
};

/// The sections of a scene.
std::vector<SectionKind> grammar();

} // namespace kerf::scene
