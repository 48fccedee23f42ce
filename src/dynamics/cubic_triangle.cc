#include "dynamics/cubic_triangle.h"

#include <deal.II/base/quadrature_lib.h>

#include <vector>

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

TrianglePoint point_at(const Vec3& L, const double weight) {
  TrianglePoint point{weight, L, {}, {}, {}};
  for (std::size_t i = 0; i < n_triangle_nodes; ++i) {
    const Value a = factor(thirds[i][0], L[0]), b = factor(thirds[i][1], L[1]), c = factor(thirds[i][2], L[2]);
    const double from_first = a.slope * b.value * c.value;
    point.shape[i] = a.value * b.value * c.value;
    point.du[i] = a.value * b.slope * c.value - from_first;
    point.dv[i] = a.value * b.value * c.slope - from_first;
  }
  return point;
}

} // namespace

Vec3 triangle_node(const std::size_t i) { return Vec3(thirds[i][0], thirds[i][1], thirds[i][2]) / 3; }

std::span<const TrianglePoint> triangle_rule() {
  static const auto rule = [] {
    std::vector<TrianglePoint> points;
    const dealii::QWitherdenVincentSimplex<2> places(4);
    for (unsigned q = 0; q < places.size(); ++q) {
      const auto& at = places.point(q);
      points.push_back(point_at(Vec3(1 - at[0] - at[1], at[0], at[1]), places.weight(q)));
    }
    return points;
  }();
  return rule;
}

} // namespace kerf::dynamics
