#pragma once

/// Triangle meshes as plain arrays, and how they are read. Whether a mesh is the skin of a solid: solid.h.

#include "base/vec.h"

#include <string>
#include <vector>

namespace kerf::geometry {

struct TriangleMesh {
  Points vertices; ///< [m]
  std::vector<Triangle> triangles;
};

/// The corners of triangle i [m].
std::array<Vec3, 3> corners(const TriangleMesh& mesh, std::size_t i);

/// Reads OFF, OBJ, STL or PLY; coordinates are multiplied by `unit` [m]. Polygons are triangulated; vertices of an STL
/// file, which repeats them, are merged where they coincide. Throws DataError: file missing, of an unknown kind,
/// unreadable or empty, an index out of range, a coordinate that is not finite, a polygon that no fan of triangles
/// fills.
TriangleMesh read_mesh(const std::string& path, double unit);

/// The enclosed volume [m^3]; positive when the triangles are counter-clockwise seen from outside.
double volume(const TriangleMesh& mesh);

/// The smallest box around the vertices [m]; of no extent at the origin when there are none.
Box bounding_box(const TriangleMesh& mesh);

/// Has it an edge of an odd number of triangles?
bool has_border(const TriangleMesh& mesh);

/// For each triangle its shell, numbered from 0 in order of first triangles: triangles that share vertices are one
/// shell.
std::vector<std::uint32_t> shells(const TriangleMesh& mesh);

} // namespace kerf::geometry
