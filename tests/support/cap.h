#pragma once

/// A mesh that ends: a part of a sphere around a pole.

#include "geometry/triangle_mesh.h"

#include <Eigen/Geometry>

#include <cmath>
#include <numbers>

namespace kerf::support {

/// Up to `reach` from its pole, along it; `radius` of the sphere, flat where it is 0 [m]. It bends away from `normal`.
inline geometry::TriangleMesh cap(const Vec3& pole, const Vec3& normal, const double radius, const double reach,
                                  const int n_rings) {
  constexpr std::uint32_t n = 48; // a ring
  const Vec3 u = normal.unitOrthogonal(), v = normal.cross(u);
  geometry::TriangleMesh mesh{{pole}, {}};
  for (int ring = 1; ring <= n_rings; ++ring)
    for (std::uint32_t i = 0; i < n; ++i) {
      const double along = reach * ring / n_rings, angle = 2 * std::numbers::pi * i / n;
      const double out = radius > 0 ? radius * std::sin(along / radius) : along,
                   down = radius > 0 ? radius * (1 - std::cos(along / radius)) : 0;
      mesh.vertices.push_back(pole + out * (std::cos(angle) * u + std::sin(angle) * v) - down * normal);
    }
  const auto at = [&](const int ring, const std::uint32_t i) { return ring == 0 ? 0 : 1 + (ring - 1) * n + i % n; };
  for (int ring = 1; ring <= n_rings; ++ring)
    for (std::uint32_t i = 0; i < n; ++i) {
      mesh.triangles.push_back({at(ring - 1, i), at(ring, i), at(ring, i + 1)});
      if (ring > 1)
        mesh.triangles.push_back({at(ring - 1, i), at(ring, i + 1), at(ring - 1, i + 1)});
    }
  return mesh;
}

} // namespace kerf::support
