#pragma once

/// What a scene may say: the tree of sections, and the parameters that belong to no module below.

#include "scene/grammar_body.h"
#include "scene/grammar_output.h"
#include "scene/grammar_tools.h"

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

/// The sections of a scene.
std::vector<SectionKind> grammar();

} // namespace kerf::scene
