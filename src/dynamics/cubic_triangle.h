#pragma once

/// The image of a flat triangle under a trilinear map: cubic in the triangle's plane, so ten points tell it, the
/// vertices, two on each side and the middle, in thirds (the cubic triangle of Zienkiewicz and Taylor, The Finite
/// Element Method, volume 1, section 8.8).

#include "base/vec.h"

namespace kerf::dynamics {

constexpr int n_triangle_nodes = 10, n_triangle_points = 15;

/// Barycentric coordinates of node i.
Vec3 triangle_node(int i);

/// An integration rule that is exact for degree 7: a shape function times the normal of the image, which is of degree
/// 4. A row a point.
struct TriangleRule {
  using AtNodes = Eigen::Matrix<double, n_triangle_points, n_triangle_nodes>;

  Eigen::Matrix<double, n_triangle_points, 1> weight; ///< they sum to 1/2
  Eigen::Matrix<double, n_triangle_points, 3> L;      ///< barycentric coordinates
  AtNodes shape;                                      ///< shape functions, 1 at one node and 0 at the others
  AtNodes du, dv; ///< their derivatives along the sides from vertex 0 to 1 and to 2
};

const TriangleRule& triangle_rule();

} // namespace kerf::dynamics
