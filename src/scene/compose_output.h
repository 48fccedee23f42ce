#pragma once

/// Output, images and observables from their sections.

#include "scene/composing.h"
#include "scene/world.h"

namespace kerf::scene {

/// What files hold. Throws ParameterError for what is no field, named twice, or not there for the physics of a body.
void compose_output(const Section& section, World& world);

/// Starts the graphics. Throws ParameterError for a camera that cannot see.
Images compose_images(const Section& section);

/// Gives every body the series that the section names, and opens accounts where they need them; the world has its
/// tools. Throws ParameterError for what is no observable, named twice, or about nothing in the scene.
void compose_observables(const Section& section, World& world);

} // namespace kerf::scene
