#pragma once

/// From a scene's text to a world: the only place that turns names into makers.

#include "scene/parameter_file.h"
#include "scene/world.h"

namespace kerf::scene {

/// Composes what the scene names, and nothing else. Relative mesh paths start at the folder of the scene file.
/// Throws ParameterError for what the scene asks and cannot be, or says and nothing reads; DataError for a mesh that
/// cannot be used.
World compose(const SceneText& text);

} // namespace kerf::scene
