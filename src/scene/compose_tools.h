#pragma once

/// Tools from their sections. All throw as compose().

#include "scene/composing.h"
#include "scene/world.h"

namespace kerf::scene {

/// Adds the blade of a section `Blade` to the world.
void compose_blade(const Section& section, World& world);

/// Adds the two blades of a section `Scissors`, and their handles.
void compose_scissors(const Section& section, World& world);

/// Adds the forceps of a section; the world has its bodies.
void compose_forceps(const Section& section, World& world);

/// Throws ParameterError when all these blades of a section stay away from every body of the world: it is a mistake.
void require_meeting(const Section& section, std::span<const cut::Blade> blades, const World& world);

} // namespace kerf::scene
