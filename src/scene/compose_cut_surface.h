#pragma once

/// Surfaces that cut at once, from their sections.

#include "scene/composing.h"
#include "scene/world.h"

namespace kerf::scene {

/// The next cut surface of the world, which has its blades and earlier surfaces. Throws as compose().
TimedSurface compose_cut_surface(const Section& section, const World& world);

} // namespace kerf::scene
