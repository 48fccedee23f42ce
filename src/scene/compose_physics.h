#pragma once

/// Physics by name: material, elements, integrator. A new one is a branch here and a section in grammar_body.

#include "scene/body.h"
#include "scene/composing.h"
#include "scene/grammar_body.h"

namespace kerf::scene {

/// What makes the physics of a body, again after every cut, as the section of the body says.
std::function<Physics(const Body&)> physics_maker(const Section& section, const BodyParameters& parameters);

} // namespace kerf::scene
