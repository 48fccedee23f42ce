#pragma once

/// Cells wholly inside the body, whose source points enclose every point of theirs (thesis §3.4.2.2).

#include "texture/partition.h"
#include "texture/weights.h"

namespace kerf::texture {

/// The triangles between the source points of a cell that is bounded by exemplars alone: one for each corner of the
/// cell, where three planes meet. Empty for other cells, and where more than three planes meet in a corner.
std::vector<Triple> enclosing_triangles(const Cell& cell, const geometry::TriangleMesh& body);

} // namespace kerf::texture
