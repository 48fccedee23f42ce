#pragma once

/// What holds and loads a body, from its sections. All throw as compose().

#include "scene/body.h"
#include "scene/composing.h"

namespace kerf::scene {

/// Adds the supports, loads and probes of a body's section, and the floors of the scene, to a body that has not
/// started.
void compose_loads(const Section& section, const std::vector<const Section*>& floors, Body& body);

/// After the start: throws ParameterError for a support or load that acts on nothing, a probe outside of the material,
/// and supports that want one corner in different places.
void require_sound_loads(const Section& section, double end_time, const Body& body);

/// A line for each support that holds the skin: its area at rest, from where to where, in how many pieces.
std::vector<std::string> describe_skin_supports(const Section& section, const Body& body);

/// A line for each floor whose friction steps of an explicit integrator, or of shape matching, are too long for: what
/// rests on it quivers then (dynamics/floor.h). As under a body that stands there with all its height.
std::vector<std::string> warn_of_friction(const Section& section, const std::vector<const Section*>& floors,
                                          const Body& body, double time_step);

/// For statics, with everything there that holds the body at the start: throws ParameterError that names the rigid
/// motions that nothing resists, unless the section allows them.
void require_static_answer(const Section& section, const Body& body);

} // namespace kerf::scene
