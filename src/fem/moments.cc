#include "fem/moments.h"

#include "grid/material.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <deal.II/base/quadrature_lib.h>

#include <span>
#include <vector>

namespace kerf::fem {

namespace {

/// A rule for the unit tetrahedron in lanes, exact for degree 7, all weights positive; a tetrahedron needs degree 6.
/// Lanes beyond its points weigh nothing.
struct Rule {
  static constexpr std::size_t n = 36;
  alignas(32) double point[3][n] = {};
  alignas(32) double weight[n] = {};
};

const Rule& tetrahedron_rule() {
  static const Rule rule = [] {
    const dealii::QWitherdenVincentSimplex<3> points(4);
    Rule lanes;
    for (unsigned q = 0; q < points.size(); ++q) {
      for (unsigned i = 0; i < 3; ++i)
        lanes.point[i][q] = points.point(q)[i];
      lanes.weight[q] = points.weight(q);
    }
    return lanes;
  }();
  return rule;
}

/// The moments of tetrahedra, four points of the rule at a time.
__attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default"))) void add(
  const std::span<const grid::Tetrahedron> tetrahedra, const Rule& rule, Moments& m) {
  typedef double V __attribute__((vector_size(32)));
  constexpr std::size_t n = Rule::n / 4;
  V sum[27] = {};
  for (const grid::Tetrahedron& t : tetrahedra) {
    const Vec3 &o = t[0], a = t[1] - o, b = t[2] - o, c = t[3] - o;
    const double jacobian = a.dot(b.cross(c));
    V x[n], y[n], z[n], w[n];
    for (std::size_t q = 0; q < n; ++q) {
      const V u = *reinterpret_cast<const V*>(rule.point[0] + 4 * q),
              v = *reinterpret_cast<const V*>(rule.point[1] + 4 * q),
              s = *reinterpret_cast<const V*>(rule.point[2] + 4 * q);
      x[q] = o[0] + u * a[0] + v * b[0] + s * c[0];
      y[q] = o[1] + u * a[1] + v * b[1] + s * c[1];
      z[q] = o[2] + u * a[2] + v * b[2] + s * c[2];
      w[q] = jacobian * *reinterpret_cast<const V*>(rule.weight + 4 * q);
    }
    for (std::size_t k = 0; k < 3; ++k) { // nine sums stay in registers
      V* const of_k = sum + 9 * k;
      V s0 = of_k[0], s1 = of_k[1], s2 = of_k[2], s3 = of_k[3], s4 = of_k[4], s5 = of_k[5], s6 = of_k[6], s7 = of_k[7],
        s8 = of_k[8];
      for (std::size_t q = 0; q < n; ++q) {
        const V f0 = w[q], f1 = f0 * x[q], f2 = f1 * x[q], yy = y[q] * y[q];
        s0 += f0;
        s1 += f1;
        s2 += f2;
        s3 += f0 * y[q];
        s4 += f1 * y[q];
        s5 += f2 * y[q];
        s6 += f0 * yy;
        s7 += f1 * yy;
        s8 += f2 * yy;
        w[q] *= z[q];
      }
      of_k[0] = s0;
      of_k[1] = s1;
      of_k[2] = s2;
      of_k[3] = s3;
      of_k[4] = s4;
      of_k[5] = s5;
      of_k[6] = s6;
      of_k[7] = s7;
      of_k[8] = s8;
    }
  }
  for (std::size_t i = 0; i < m.size(); ++i)
    m[i] += (sum[i][0] + sum[i][1]) + (sum[i][2] + sum[i][3]);
}

/// Integrals of the products of 1, x, y, xy, z, ..: of which trilinear fields are made.
using Products = Eigen::Matrix<double, 8, 8>;

Products products(const Moments& m) {
  const auto power = [](const int a, const int b, const int axis) { return (a >> axis & 1) + (b >> axis & 1); };
  Products result;
  for (int a = 0; a < 8; ++a)
    for (int b = 0; b < 8; ++b)
      result(a, b) = m[power(a, b, 0) + 3 * power(a, b, 1) + 9 * power(a, b, 2)];
  return result;
}

} // namespace

Moments full_cube_moments() {
  Moments m;
  for (int n = 0; n < 27; ++n)
    m[n] = 1.0 / ((n % 3 + 1) * (n / 3 % 3 + 1) * (n / 9 + 1));
  return m;
}

Moments octant_moments(const grid::Solid& solid, const grid::CellId cell, const unsigned vertices) {
  Moments m{};
  for (int vertex = 0; vertex < 8; ++vertex)
    if (vertices >> vertex & 1)
      add(grid::octant(solid, cell, vertex), tetrahedron_rule(), m);
  return m;
}

Moments without_negative_squares(const Moments& m) {
  if (Eigen::LLT<Products>(products(m)).info() == Eigen::Success)
    return m; // all but slivers
  Moments spread = full_cube_moments();
  for (double& moment : spread)
    moment *= m[0];
  using Solver = Eigen::GeneralizedSelfAdjointEigenSolver<Products>;
  const double least = Solver(products(m), products(spread), Eigen::EigenvaluesOnly).eigenvalues()[0];
  if (least >= 0)
    return m;
  const double part = least / (least - 1); // least (1 - part) + part = 0
  Moments result;
  for (int n = 0; n < 27; ++n)
    result[n] = (1 - part) * m[n] + part * spread[n];
  return result;
}

Moments material_moments(const grid::Solid& solid, const grid::Copy& copy) {
  constexpr double least = 1e-12; // far below what counts
  std::vector<grid::Tetrahedron> tetrahedra;
  grid::for_each_tetrahedron(solid, copy, [&](const grid::Tetrahedron& t, int) { tetrahedra.push_back(t); });
  Moments m{};
  add(tetrahedra, tetrahedron_rule(), m);
  if (m[0] >= least)
    return m;
  m = full_cube_moments();
  for (double& moment : m)
    moment *= least;
  return m;
}

} // namespace kerf::fem
