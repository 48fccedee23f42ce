#include "fem/moments.h"

#include "grid/material.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <deal.II/base/quadrature_lib.h>

namespace kerf::fem {

namespace {

/// Exact for degree 7, all weights positive; a tetrahedron needs degree 6.
const dealii::Quadrature<3>& tetrahedron_rule() {
  static const dealii::QWitherdenVincentSimplex<3> rule(4);
  return rule;
}

void add(Moments& m, const Vec3& p, const double weight) {
  double wz = weight;
  for (int k = 0; k < 3; ++k, wz *= p[2]) {
    double wy = wz;
    for (int j = 0; j < 3; ++j, wy *= p[1]) {
      double wx = wy;
      for (int i = 0; i < 3; ++i, wx *= p[0])
        m[i + 3 * j + 9 * k] += wx;
    }
  }
}

void add(Moments& m, const grid::Tetrahedron& t) {
  const auto& rule = tetrahedron_rule();
  const Vec3 a = t[1] - t[0], b = t[2] - t[0], c = t[3] - t[0];
  const double jacobian = a.dot(b.cross(c));
  if (jacobian == 0)
    return;
  for (unsigned q = 0; q < rule.size(); ++q) {
    const auto& xi = rule.point(q);
    add(m, t[0] + xi[0] * a + xi[1] * b + xi[2] * c, jacobian * rule.weight(q));
  }
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
      for (const grid::Tetrahedron& t : grid::octant(solid, cell, vertex))
        add(m, t);
  return m;
}

Moments without_negative_squares(const Moments& m) {
  if (Eigen::LLT<Products>(products(m)).info() == Eigen::Success)
    return m; // all but slivers and folds
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
  Moments m{};
  grid::for_each_tetrahedron(solid, copy, [&](const grid::Tetrahedron& t, int) { add(m, t); });
  if (m[0] >= least)
    return m;
  m = full_cube_moments();
  for (double& moment : m)
    moment *= least;
  return m;
}

} // namespace kerf::fem
