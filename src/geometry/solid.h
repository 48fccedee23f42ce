#pragma once

/// Is a triangle mesh the skin of a solid? Closed, two-manifold, orientable, without degenerate triangles, without
/// self-intersections, around a volume. Each defect has its own message, with a count and one place where to look.
///
/// Several shells are allowed; a shell inside another one is a void in it (and one inside a void is solid again).

#include "geometry/triangle_mesh.h"

namespace kerf::geometry {

/// The mesh, oriented so that its triangles are counter-clockwise seen from outside the material: shells that are
/// inside out are flipped. Throws DataError that names `path` when the mesh is not the skin of a solid.
TriangleMesh require_solid(TriangleMesh mesh, const std::string& path);

/// All pairs of triangles that intersect elsewhere than in a vertex or edge they share; triangles must not be
/// degenerate.
std::vector<std::array<std::uint32_t, 2>> self_intersections(const TriangleMesh& mesh);

} // namespace kerf::geometry
