#pragma once

/// Closed meshes that tests make themselves.

#include "geometry/triangle_mesh.h"

#include <map>

namespace kerf::geometry {

inline TriangleMesh box_mesh(const Vec3& lower, const Vec3& upper) {
  TriangleMesh mesh;
  for (int v = 0; v < 8; ++v)
    mesh.vertices.emplace_back(v & 1 ? upper[0] : lower[0], v & 2 ? upper[1] : lower[1], v & 4 ? upper[2] : lower[2]);
  mesh.triangles = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
  return mesh;
}

/// An octahedron whose triangles are split in four n times, its vertices put on the sphere: 8 * 4^n triangles.
inline TriangleMesh sphere_mesh(const double radius, const Vec3& centre, const int n) {
  TriangleMesh mesh;
  mesh.vertices = {Vec3::UnitX(), -Vec3::UnitX(), Vec3::UnitY(), -Vec3::UnitY(), Vec3::UnitZ(), -Vec3::UnitZ()};
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int level = 0; level < n; ++level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](const std::uint32_t a, const std::uint32_t b) {
      const auto [position, is_new] =
        middles.emplace(std::minmax(a, b), static_cast<std::uint32_t>(mesh.vertices.size()));
      if (is_new)
        mesh.vertices.push_back((mesh.vertices[a] + mesh.vertices[b]).normalized());
      return position->second;
    };
    std::vector<Triangle> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    mesh.triangles = std::move(finer);
  }
  for (Vec3& v : mesh.vertices)
    v = centre + radius * v;
  return mesh;
}

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
