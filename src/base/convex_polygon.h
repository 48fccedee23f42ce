#pragma once

/// Convex polygons in space that planes clip.

#include "base/vec.h"

#include <array>
#include <cstddef>

namespace kerf {

/// Of at most `room` vertices.
template <std::size_t room>
struct ConvexPolygon {
  std::size_t n = 0;
  std::array<Vec3, room> vertices;

  void push_back(const Vec3& p) {
    if (n < room) // a plane adds one vertex at most, but where round-off makes a flat polygon seem to bend
      vertices[n++] = p;
  }
};

/// Its part above the plane normal . p = d.
template <std::size_t room>
ConvexPolygon<room> clipped(const ConvexPolygon<room>& polygon, const Vec3& normal, const double d) {
  ConvexPolygon<room> kept;
  for (std::size_t i = 0; i < polygon.n; ++i) {
    const Vec3 &p = polygon.vertices[i], &q = polygon.vertices[(i + 1) % polygon.n];
    const double a = normal.dot(p) - d, b = normal.dot(q) - d;
    if (a > 0)
      kept.push_back(p);
    if ((a > 0) != (b > 0))
      kept.push_back(p + a / (a - b) * (q - p));
  }
  return kept;
}

} // namespace kerf
