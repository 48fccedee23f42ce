#pragma once

/// What a scene composes: only what it names.

#include "render/renderer.h"
#include "scene/body.h"
#include "scene/grammar.h"
#include "scene/observables.h"

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

struct World {
  double time_step = 0; ///< [s]
  int n_steps = 0;
  std::vector<Body> bodies;
  std::vector<cut::Blade> blades;
  std::vector<TimedSurface> cut_surfaces;
  OutputParameters output;
  std::optional<SurfaceFileParameters> surface_file;
  std::optional<Images> images; ///< empty in a scene without images: no GL context exists
  std::vector<const BodyObservable*> observables;

  std::vector<std::string> composition; ///< what was composed and what was left out, a line each
  Timings setup_seconds;                ///< of composing, per stage [s]
};

} // namespace kerf::scene
