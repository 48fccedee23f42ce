#pragma once

/// What exact Boolean operations on the skin say of planes, and of bent sheets, that cut a solid.

#include "geometry/triangle_mesh.h"
#include "tests/support/bodies.h"

#include <optional>
#include <vector>

namespace kerf::cut {

/// Volumes of what planes leave of a solid whose skin is closed, ascending [m^3]: by corefinement with each plane in
/// turn. Nothing where the skin intersects itself at a plane.
std::optional<std::vector<double>> volumes_between(const geometry::TriangleMesh& skin,
                                                   const std::vector<support::Plane>& planes);

/// The same of what lies inside and outside of a closed mesh.
std::optional<std::vector<double>> volumes_beside(const geometry::TriangleMesh& skin,
                                                  const geometry::TriangleMesh& closed);

/// Volume of a solid where the plane's height is negative [m^3]; nothing where its skin intersects itself at the plane.
std::optional<double> volume_below(const geometry::TriangleMesh& skin, const support::Plane& plane);

} // namespace kerf::cut
