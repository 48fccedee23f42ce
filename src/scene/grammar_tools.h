#pragma once

/// What a scene may say of tools, and of surfaces that cut.

#include "scene/text_grammar.h"

#include <string>
#include <vector>

namespace kerf::scene {

/// The rigid motion of a tool by key frames.
struct MotionParameters {
  std::vector<double> times; ///< [s]
  Points positions;          ///< [m]
  Points rotations;          ///< [degrees]
  void describe(Parameters& p);
};

struct BladeParameters {
  Points edge; ///< blade frame [m]
  std::string edge_form = "polyline";
  Vec3 spine = Vec3::Zero(); ///< blade frame [m]
  void describe(Parameters& p);
};

struct ScissorsParameters {
  Vec3 pivot = Vec3::Zero(); ///< tool frame [m]
  Vec3 axis = Vec3::UnitZ(); ///< any length, tool frame [1]
  Points edge, second_edge;  ///< when closed, tool frame [m]
  std::string edge_form = "polyline";
  Vec3 spine = Vec3::Zero();         ///< of the first blade when closed, tool frame [m]
  double handle = 0;                 ///< [m]
  std::vector<double> opening_times; ///< [s]
  std::vector<double> openings;      ///< [degrees]
  void describe(Parameters& p);
};

struct ForcepsParameters {
  double grip_time = 0;       ///< [s]
  double release_time = 1e9;  ///< [s]
  Vec3 jaws = Vec3::Zero();   ///< tool frame [m]
  Vec3 handle = Vec3::Zero(); ///< tool frame [m]
  std::string region;
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
  Vec3 point = Vec3::Zero();                                    ///< [m]
  Vec3 normal = Vec3::UnitZ(), axis = Vec3::UnitZ();            ///< any length [1]
  Vec3 first_side = Vec3::UnitX(), second_side = Vec3::UnitY(); ///< [m]
  double radius = 0.01, height = 0.01;                          ///< [m]
  std::string mesh;
  double mesh_unit = 1; ///< [m]
  void describe(Parameters& p);
};

/// The sections of tools and of surfaces that cut.
std::vector<SectionKind> tool_kinds();

} // namespace kerf::scene
