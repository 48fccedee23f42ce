#pragma once

/// What a scene may say of a body: its mesh, grid, material, damping, supports, loads, probes.

#include "scene/text_grammar.h"

#include <string>
#include <vector>

namespace kerf::scene {

/// What a body is made of: a mesh file, or a simple body. Describes the keys of `shape`; those of all shapes while it
/// is empty.
struct BodyShapeParameters {
  std::string shape;
  std::string mesh;
  double mesh_unit = 1;          ///< [m]
  Vec3 centre = Vec3::Zero();    ///< [m]
  Vec3 sides = Vec3::Ones();     ///< [m]
  double radius = 1, height = 1; ///< [m]
  Vec3 axis = Vec3::UnitZ();     ///< any length [1]
  Vec3 rotation = Vec3::Zero();  ///< rotation vector [degrees]
  void describe(Parameters& p);
};

struct BodyParameters {
  std::string shape = "mesh";
  double cube_edge = 0.01;                   ///< [m]
  Vec3 lattice_offset = Vec3::Constant(0.5); ///< parts of a cube edge [1]
  double sharp_angle = 45;                   ///< [degrees]
  std::string backend = "fem";
  std::string integration = "octants";
  std::string element = "trilinear";
  std::string mass = "lumped";
  std::string integrator = "implicit Euler";
  void describe(Parameters& p);
};

struct DampingParameters {
  double mass = 0;      ///< [1/s]
  double stiffness = 0; ///< [s]
  void describe(Parameters& p);
};

/// What is held of a region, and how it is moved.
struct SupportParameters {
  std::string region = "box";
  std::string hold = "all";
  std::string hold_at = "corners";
  double skin_stiffness = 100;   ///< over Young's modulus and a cube's edge [1]
  Vec3 direction = Vec3::Zero(); ///< [1]; zero: what `hold` says
  std::string displacement = "0; 0; 0";
  std::string rotation = "0; 0; 0"; ///< [degrees]
  Vec3 pivot = Vec3::Zero();        ///< [m]
  void describe(Parameters& p);
};

struct ProbeParameters {
  Vec3 point = Vec3::Zero(); ///< rest configuration [m]
  void describe(Parameters& p) {
    p.vector("Point [m]", point, "A point of the body's material, rest configuration.");
    p.require_last();
  }
};

/// The section `Body` with all that stands in it.
std::vector<SectionKind> body_kinds();

} // namespace kerf::scene
