#pragma once

/// A body from its section: mesh, grid, physics, supports.

#include "scene/composing.h"
#include "scene/world.h"

namespace kerf::scene {

/// Composes a body that what `world` has to cut with can cut, and says what it is in the world's composition. `gravity`
/// is null without a field. Throws as compose().
Body compose_body(const Section& section, const GravityParameters* gravity, const std::vector<const Section*>& floors,
                  World& world);

/// The body's mesh, oriented as the skin of a solid. Throws DataError at the key Mesh.
geometry::TriangleMesh read_body_mesh(const Section& section, const BodyParameters& parameters);

} // namespace kerf::scene
