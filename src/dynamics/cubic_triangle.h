#pragma once

/// The image of a flat triangle under a trilinear map: cubic in the triangle's plane, so ten points tell it, the
/// vertices, two on each side and the middle, in thirds (the cubic triangle of Zienkiewicz and Taylor, The Finite
/// Element Method, volume 1, section 8.8).

#include "base/vec.h"

#include <array>
#include <span>

namespace kerf::dynamics {

constexpr std::size_t n_triangle_nodes = 10;

/// Numbers at a triangle's ten nodes.
using AtNodes = std::array<double, n_triangle_nodes>;

/// Barycentric coordinates of node i.
Vec3 triangle_node(std::size_t i);

/// A point of an integration rule.
struct TrianglePoint {
  double weight; ///< they sum to 1/2
  Vec3 L;        ///< barycentric coordinates
  AtNodes shape; ///< shape functions, 1 at one node and 0 at the others
  AtNodes du, dv; ///< their derivatives along the sides from vertex 0 to 1 and to 2
};

/// Exact for degree 7: a shape function times the normal of the image, which is of degree 4.
std::span<const TrianglePoint> triangle_rule();

} // namespace kerf::dynamics
