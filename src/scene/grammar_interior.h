#pragma once

/// What a scene may say of a body's inside: sections, how they become colours, and what is done with those.

#include "scene/text_grammar.h"

#include <string>
#include <vector>

namespace kerf::scene {

struct InteriorParameters {
  double resolution = 0.001; ///< [m]
  std::string morph = "first order";
  std::string weights = "Shepard";
  double power = 1; ///< [1]
  std::string warps = "all";
  std::string components = "one";
  bool small_features = false;
  double relief = 0; ///< [m]
  std::string skin_image;
  Vec3 skin_axis = Vec3::UnitZ(); ///< [1]
  int levels = 4, cells = 16, match_pixels = 192;
  double edges = 1, brightness = 1, outline = 1, stiffness = 8; ///< [1]
  std::string global = "none";
  void describe(Parameters& p);
};

struct ExemplarParameters {
  std::string image;
  std::string background = "alpha";
  Vec3 origin = Vec3::Zero(), column = Vec3::Zero(), row = Vec3::Zero(); ///< [m]
  std::string fit = "none";
  std::string sweep = "normal";
  Vec3 centre = Vec3::Zero(); ///< [m]
  Vec3 axis = Vec3::Zero();   ///< [1]
  void describe(Parameters& p);
};

struct PinParameters {
  std::string from_exemplar, to_exemplar;
  Vec3 from = Vec3::Zero(), to = Vec3::Zero(); ///< [m]
  void describe(Parameters& p);
};

/// The section `Interior` of a body, with all that stands in it.
SectionKind interior_kind();

} // namespace kerf::scene
