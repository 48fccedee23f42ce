#pragma once

/// What a scene may say of what a run writes.

#include "scene/text_grammar.h"

#include <string>
#include <vector>

namespace kerf::scene {

struct OutputParameters {
  int frames_every = 10; ///< steps
  std::string fields = "none";
  double checkpoint_interval = 60; ///< [s] of the clock
  int checkpoint_every = 0;        ///< steps; 0: by the clock
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

/// The sections of what a run writes.
std::vector<SectionKind> output_kinds();

} // namespace kerf::scene
