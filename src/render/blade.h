#pragma once

/// The solid that stands for a blade in an image.

#include "base/vec.h"

#include <cstdint>
#include <vector>

namespace kerf::render {

struct BladeMesh {
  Points positions; ///< [m]
  std::vector<Triangle> triangles;
  std::vector<std::uint16_t> labels; ///< 0 side, 1 bevel, 2 back and ends: neighbours that meet in a sharp edge
};

/// A closed plate on the polyline `edge` [m] that reaches to `edge + spine` [m], thin beside its depth, ground to zero
/// thickness at the edge. Empty if the edge is shorter than two different points or the spine is null.
BladeMesh blade_mesh(const Points& edge, const Vec3& spine);

} // namespace kerf::render
