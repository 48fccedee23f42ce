#include "dynamics/cubic_triangle.h"

#include <deal.II/base/quadrature_lib.h>

#include <array>
#include <stdexcept>

namespace kerf::dynamics {

namespace {

/// Thirds from the sides that lie across from the three vertices.
constexpr std::array<std::array<int, 3>, n_triangle_nodes> thirds = {{{3, 0, 0},
                                                                      {0, 3, 0},
                                                                      {0, 0, 3},
                                                                      {2, 1, 0},
                                                                      {1, 2, 0},
                                                                      {0, 2, 1},
                                                                      {0, 1, 2},
                                                                      {1, 0, 2},
                                                                      {2, 0, 1},
                                                                      {1, 1, 1}}};

/// With its derivative.
struct Value {
  double value, slope;
};

/// The polynomial of L that vanishes at 0, 1/3, .. (n - 1) / 3, and is 1 at n / 3.
Value factor(const int n, const double L) {
  Value of = {1, 0};
  for (int k = 0; k < n; ++k) {
    const double f = (3 * L - k) / (k + 1);
    of = {of.value * f, of.slope * f + of.value * 3 / (k + 1)};
  }
  return of;
}

void put(TriangleRule& rule, const int q, const Vec3& L, const double weight) {
  rule.weight[q] = weight;
  rule.L.row(q) = L;
  for (int i = 0; i < n_triangle_nodes; ++i) {
    const Value a = factor(thirds[i][0], L[0]), b = factor(thirds[i][1], L[1]), c = factor(thirds[i][2], L[2]);
    const double from_first = a.slope * b.value * c.value;
    rule.shape(q, i) = a.value * b.value * c.value;
    rule.du(q, i) = a.value * b.slope * c.value - from_first;
    rule.dv(q, i) = a.value * b.value * c.slope - from_first;
  }
}

} // namespace

Vec3 triangle_node(const int i) { return Vec3(thirds[i][0], thirds[i][1], thirds[i][2]) / 3; }

const TriangleRule& triangle_rule() {
  static const TriangleRule rule = [] {
    const dealii::QWitherdenVincentSimplex<2> places(4);
    if (places.size() != n_triangle_points)
      throw std::logic_error("deal.II's rule of degree 7 for triangles has other points");
    TriangleRule of;
    for (int q = 0; q < n_triangle_points; ++q) {
      const auto& at = places.point(q);
      put(of, q, Vec3(1 - at[0] - at[1], at[0], at[1]), places.weight(q));
    }
    return of;
  }();
  return rule;
}

} // namespace kerf::dynamics
