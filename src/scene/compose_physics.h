#pragma once

/// Physics by name: backend, material, elements, integrator. A new backend is a branch here, a section in
/// grammar_physics, and a class in physics/.

#include "scene/body.h"
#include "scene/composing.h"
#include "scene/grammar_body.h"

namespace kerf::scene {

/// What makes the physics of a body, as its section says. Throws ParameterError for a pairing that makes no sense.
PhysicsMaker physics_maker(const Section& section, const BodyParameters& parameters, double time_step);

/// Keys of a body's section that its backend does not look at.
std::vector<std::string> keys_left_out(const BodyParameters& parameters);

} // namespace kerf::scene
