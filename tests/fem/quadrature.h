#pragma once

/// Integration and trilinear shape functions, independent of the library: products of Gauss-Legendre rules, collapsed
/// onto triangles and tetrahedra.

#include "base/vec.h"
#include "grid/material.h"

#include <cmath>
#include <numbers>
#include <vector>

namespace kerf::fem {

template <class Point>
struct WeightedPoint {
  Point x;
  double weight;
};

/// n points on [0, 1], exact for degree 2 n - 1: the roots of Legendre's polynomial by Newton's method.
inline std::vector<WeightedPoint<double>> gauss_rule(const int n) {
  std::vector<WeightedPoint<double>> rule;
  for (int i = 0; i < n; ++i) {
    double x = std::cos(std::numbers::pi * (i + 0.75) / (n + 0.5)), slope = 1;
    for (int iteration = 0; iteration < 50; ++iteration) {
      double p = 1, before = 0;
      for (int k = 1; k <= n; ++k) {
        const double next = ((2 * k - 1) * x * p - (k - 1) * before) / k;
        before = p;
        p = next;
      }
      slope = n * (x * p - before) / (x * x - 1);
      x -= p / slope;
    }
    rule.push_back({0.5 * (1 + x), 1 / ((1 - x * x) * slope * slope)});
  }
  return rule;
}

/// On the unit cube, exact for degree 2 n - 1 in each coordinate.
inline std::vector<WeightedPoint<Vec3>> cube_rule(const int n) {
  std::vector<WeightedPoint<Vec3>> rule;
  const auto line = gauss_rule(n);
  for (const auto& [x, wx] : line)
    for (const auto& [y, wy] : line)
      for (const auto& [z, wz] : line)
        rule.push_back({{x, y, z}, wx * wy * wz});
  return rule;
}

/// On a tetrahedron, exact for total degree 2 n - 3; weights carry its signed volume.
inline std::vector<WeightedPoint<Vec3>> tetrahedron_rule(const grid::Tetrahedron& t, const int n) {
  Mat3 J;
  J << t[1] - t[0], t[2] - t[0], t[3] - t[0];
  const double det = J.col(0).dot(Vec3(J(1, 1) * J(2, 2) - J(2, 1) * J(1, 2), J(2, 1) * J(0, 2) - J(0, 1) * J(2, 2),
                                       J(0, 1) * J(1, 2) - J(1, 1) * J(0, 2)));
  std::vector<WeightedPoint<Vec3>> rule = cube_rule(n);
  for (auto& [x, weight] : rule) {
    const double u = x[0], v = x[1], w = x[2];
    x = t[0] + J * Vec3(u, (1 - u) * v, (1 - u) * (1 - v) * w);
    weight *= det * (1 - u) * (1 - u) * (1 - v);
  }
  return rule;
}

/// On the reference triangle (0, 0), (1, 0), (0, 1), exact for total degree 2 n - 2.
inline std::vector<WeightedPoint<Eigen::Vector2d>> triangle_rule(const int n) {
  std::vector<WeightedPoint<Eigen::Vector2d>> rule;
  for (const auto& [u, wu] : gauss_rule(n))
    for (const auto& [v, wv] : gauss_rule(n))
      rule.push_back({{u, (1 - u) * v}, wu * wv * (1 - u)});
  return rule;
}

/// Points of the octants of `vertices` (bits) of a cell, in the unit cube.
inline std::vector<WeightedPoint<Vec3>> material_rule(const grid::Solid& solid, const grid::CellId cell,
                                                      const unsigned vertices, const int n) {
  std::vector<WeightedPoint<Vec3>> rule;
  for (int v = 0; v < 8; ++v)
    if (vertices >> v & 1)
      for (const auto& t : grid::octant(solid, cell, v)) {
        const auto part = tetrahedron_rule(t, n);
        rule.insert(rule.end(), part.begin(), part.end());
      }
  return rule;
}

/// Points of all material of a copy.
inline std::vector<WeightedPoint<Vec3>> material_rule(const grid::Solid& solid, const grid::Copy& copy, const int n) {
  std::vector<WeightedPoint<Vec3>> rule;
  grid::for_each_tetrahedron(solid, copy, [&](const grid::Tetrahedron& t, int) {
    const auto part = tetrahedron_rule(t, n);
    rule.insert(rule.end(), part.begin(), part.end());
  });
  return rule;
}

/// N_a at x in the unit cube.
inline double shape(const int a, const Vec3& x) {
  double N = 1;
  for (int i = 0; i < 3; ++i)
    N *= a >> i & 1 ? x[i] : 1 - x[i];
  return N;
}

/// grad N_a at x in the unit cube.
inline Vec3 shape_gradient(const int a, const Vec3& x) {
  Vec3 g;
  for (int i = 0; i < 3; ++i) {
    g[i] = a >> i & 1 ? 1 : -1;
    for (int j = 0; j < 3; ++j)
      if (j != i)
        g[i] *= a >> j & 1 ? x[j] : 1 - x[j];
  }
  return g;
}

} // namespace kerf::fem
