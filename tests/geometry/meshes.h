#pragma once

/// What tests make of closed meshes.

#include "geometry/shapes.h"

namespace kerf::geometry {

inline TriangleMesh inside_out(TriangleMesh mesh) {
  for (Triangle& triangle : mesh.triangles)
    std::swap(triangle[1], triangle[2]);
  return mesh;
}

/// Both meshes in one.
inline TriangleMesh together(TriangleMesh a, const TriangleMesh& b) {
  const auto n = static_cast<std::uint32_t>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& [i, j, k] : b.triangles)
    a.triangles.push_back({i + n, j + n, k + n});
  return a;
}

} // namespace kerf::geometry
