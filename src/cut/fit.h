#pragma once

/// Puts the skin's face and cell vertices onto the input mesh.
///
/// The input is known whole, so more can be asked than edge vertices and normals tell (thesis §2.4.3): a vertex that
/// the planes put on the mesh already stays (so sharp edges and corners of the mesh are kept); any other is moved
/// along the direction from material to empty until it meets the mesh inside its face or cell; where it does not, as
/// beside walls thinner than a cell, it goes to the nearest point of the mesh there.

#include "geometry/triangle_mesh.h"
#include "grid/solid.h"

namespace kerf::cut {

/// `cuts` holds the skin alone, placed (surface/placement.h).
void fit_skin(const geometry::TriangleMesh& mesh, grid::Solid& solid);

} // namespace kerf::cut
