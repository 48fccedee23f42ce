#pragma once

/// Images and observables from their sections.

#include "scene/composing.h"
#include "scene/world.h"

namespace kerf::scene {

/// Starts the graphics. Throws ParameterError for a camera that cannot see.
Images compose_images(const Section& section);

/// Throws ParameterError for what is no observable or named twice.
std::vector<const BodyObservable*> compose_observables(const Section& section);

} // namespace kerf::scene
