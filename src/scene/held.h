#pragma once

/// What of a body is held where a region holds it.

#include "scene/body.h"

namespace kerf::scene {

/// Particles that rest in a region [ascending]. Of corners those alone that a copy with material in the region knows:
/// after a cut the corners of a piece reach into regions in which the piece has nothing, and held there it would hang
/// on corners of hardly any stiffness.
std::vector<std::uint32_t> particles_in(const Body& body, const Region& region);
/// Of these particles [ascending].
std::vector<std::uint32_t> particles_in(const Body& body, const Region& region, std::vector<std::uint32_t> among);

} // namespace kerf::scene
