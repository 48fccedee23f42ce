#pragma once

/// Images and observables from their sections.

#include "scene/composing.h"
#include "scene/world.h"

namespace kerf::scene {

/// Starts the graphics. Throws ParameterError for a camera that cannot see.
Images compose_images(const Section& section);

/// Gives every body the series that the section names, and opens accounts where they need them; the world has its
/// tools. Throws ParameterError for what is no observable, named twice, or about nothing in the scene.
void compose_observables(const Section& section, World& world);

} // namespace kerf::scene
