#pragma once

/// The world as an image shows it: bodies, and every tool where it is.

#include "render/drawn.h"
#include "scene/world.h"

namespace kerf::scene {

/// What is to be drawn after step `step`. Refers to the world's surfaces.
render::DrawnScene drawing(const World& world, int step);

} // namespace kerf::scene
