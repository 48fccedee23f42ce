#pragma once

/// The vectors of the whole program. Points and vectors are in metres unless a name says otherwise.

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <vector>

namespace kerf {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Mat2 = Eigen::Matrix2d;
using Mat3 = Eigen::Matrix3d;

/// Lattice coordinates (i, j, k) of a node, or of the lowest node of an edge, face or cell.
using Index3 = std::array<int, 3>;

/// One point a row; 3 n contiguous doubles.
using Points = std::vector<Vec3>;

/// Vertex indices of a triangle, counter-clockwise seen from outside.
using Triangle = std::array<std::uint32_t, 3>;

/// An axis-aligned box, closed.
struct Box {
  Vec3 lower = Vec3::Constant(-1e300);
  Vec3 upper = Vec3::Constant(1e300);

  bool contains(const Vec3& p) const {
    return (p.array() >= lower.array()).all() && (p.array() <= upper.array()).all();
  }
};

/// W with W a = w x a.
inline Mat3 cross_matrix(const Vec3& w) {
  Mat3 W;
  W << 0, -w[2], w[1], w[2], 0, -w[0], -w[1], w[0], 0;
  return W;
}

} // namespace kerf
