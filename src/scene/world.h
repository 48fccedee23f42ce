#pragma once

/// What a scene composes: only what it names.

#include "render/renderer.h"
#include "scene/body.h"
#include "scene/forceps.h"
#include "scene/grammar.h"
#include "scene/observables.h"
#include "scene/soundness.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace kerf::scene {

/// Images of a run; holds the one GL context.
struct Images {
  int every = 1; ///< steps
  std::unique_ptr<render::Renderer> renderer;
};

/// A surface that cuts once.
struct TimedSurface {
  cut::CutSurface surface;
  int step = 1; ///< before which it cuts
};

/// What is drawn of scissors beside their blades.
struct ScissorsHandles {
  std::size_t first_blade = 0; ///< in World::blades; the second is the next
  Vec3 pivot = Vec3::Zero();   ///< blade frame [m]
  Vec3 axis = Vec3::UnitZ();   ///< unit, blade frame
  double length = 0;           ///< beyond the pivot [m]; 0: no handles
};

/// Where the scene sets a key: for what can only be refused while running.
struct Place {
  std::string key, file, path;
  int line = 0;
};

struct World {
  double time_step = 0; ///< [s]
  Place time_step_place = {};
  int n_steps = 0;
  std::vector<Body> bodies;
  std::vector<Watch> watches; ///< of the bodies, from the first step on
  std::vector<cut::Blade> blades; ///< those of scissors come last, in pairs
  std::vector<ScissorsHandles> scissors;
  std::vector<Forceps> forceps;
  std::vector<TimedSurface> cut_surfaces;
  OutputParameters output;
  std::vector<std::string> fields; ///< that files hold: names of fields.h
  std::optional<SurfaceFileParameters> surface_file;
  std::optional<Images> images; ///< empty in a scene without images: no GL context exists

  std::vector<std::string> composition; ///< what was composed and what was left out, a line each
  Timings setup_seconds;                ///< of composing, per stage [s]
};

} // namespace kerf::scene
