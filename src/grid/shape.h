#pragma once

/// The trilinear shape functions of the unit cube, N_v(xi) = product over the axes d of xi_d where vertex v lies at 1
/// along d, and 1 - xi_d where it lies at 0 (numbering: cube.h).

#include "base/vec.h"

namespace kerf::grid {

/// Bits of the cube's vertices at 1 along x, y, z.
constexpr std::array<unsigned, 3> upper_vertices = {0xaa, 0xcc, 0xf0};

/// N_v at `xi` [1].
inline double shape(const int v, const Vec3& xi) {
  double n = 1;
  for (int d = 0; d < 3; ++d)
    n *= v >> d & 1 ? xi[d] : 1 - xi[d];
  return n;
}

/// At `xi` between points, at(v) for each vertex v.
template <class At>
Vec3 interpolated(const Vec3& xi, const At& at) {
  Vec3 sum = Vec3::Zero();
  for (int v = 0; v < 8; ++v)
    sum += shape(v, xi) * at(v);
  return sum;
}

/// dN_v / dxi at `xi` [1].
inline Vec3 shape_gradient(const int v, const Vec3& xi) {
  Vec3 value, slope;
  for (int d = 0; d < 3; ++d) {
    value[d] = v >> d & 1 ? xi[d] : 1 - xi[d];
    slope[d] = v >> d & 1 ? 1 : -1;
  }
  return {slope[0] * value[1] * value[2], value[0] * slope[1] * value[2], value[0] * value[1] * slope[2]};
}

/// The shape function of vertex v within the edge, face or cell whose vertices are `support` (8 bits): linear, bilinear
/// or trilinear; coordinates along which the support does not reach have no say.
inline double shape(const int v, const Vec3& xi, const unsigned support) {
  double n = 1;
  for (int d = 0; d < 3; ++d)
    if ((support & upper_vertices[d]) != 0 && (support & ~upper_vertices[d]) != 0)
      n *= v >> d & 1 ? xi[d] : 1 - xi[d];
  return n;
}

} // namespace kerf::grid
