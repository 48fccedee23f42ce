#include "fem/moments.h"

#include "grid/cube.h"
#include "tests/fem/bodies.h"
#include "tests/fem/quadrature.h"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::fem {
namespace {

Moments by_quadrature(const std::vector<WeightedPoint<Vec3>>& rule) {
  Moments m{};
  for (const auto& [x, weight] : rule)
    for (int n = 0; n < 27; ++n)
      m[n] += weight * std::pow(x[0], n % 3) * std::pow(x[1], n / 3 % 3) * std::pow(x[2], n / 9);
  return m;
}

double distance(const Moments& a, const Moments& b) {
  double d = 0;
  for (int n = 0; n < 27; ++n)
    d = std::max(d, std::abs(a[n] - b[n]));
  return d;
}

TEST(Moments, OfTheFullCube) {
  EXPECT_LT(distance(full_cube_moments(), by_quadrature(cube_rule(2))), 1e-15);
  EXPECT_DOUBLE_EQ(full_cube_moments()[2 + 3 * 1 + 9 * 2], 1.0 / 3 / 2 / 3);
}

/// A body of one inner cell with the given configuration.
Body one_cell(const unsigned configuration, Draw& draw, const Interval& t) {
  Body body = make_block({2, 2, 2}, 0.7, draw, {0.3, 0.7});
  const auto cell = *body.grid.find_cell({1, 1, 1});
  std::vector<grid::EdgeCut> cuts;
  for (int line = 0; line < 12; ++line)
    if (configuration >> line & 1)
      cuts.push_back({body.grid.edges(cell)[line], draw(t.lower, t.upper), draw.vector().normalized(), 1});
  body.cut(cuts);
  return body;
}

TEST(Moments, OfTheCopiesOfACellSumToTheFullCubeInEveryConfiguration) {
  Draw draw(1);
  double worst = 0;
  for (unsigned configuration = 0; configuration < 4096; ++configuration) {
    const Body body = one_cell(configuration, draw, {0, 1});
    const auto cell = *body.grid.find_cell({1, 1, 1});
    ASSERT_EQ(body.cuts.configuration(body.grid, cell), configuration);
    Moments sum{};
    for (const grid::CopyId c : body.complex.copies_of(cell)) {
      const Moments m = material_moments(body.grid, body.cuts, body.complex.copies[c]);
      EXPECT_GT(m[0], 0);
      for (int n = 0; n < 27; ++n)
        sum[n] += m[n];
    }
    worst = std::max(worst, distance(sum, full_cube_moments()));
  }
  EXPECT_LT(worst, 1e-13);
  RecordProperty("worst", std::to_string(worst * 1e16) + "e-16");
}

TEST(Moments, OfOctantsAgreeWithAnotherRule) {
  Draw draw(2);
  for (const Interval& t : {Interval{0.1, 0.9}, Interval{0, 1}, Interval{0, 1e-6}, Interval{1 - 1e-6, 1}})
    for (int n = 0; n < 20; ++n) {
      const Body body = one_cell(static_cast<unsigned>(draw(0, 4096)), draw, t);
      const auto cell = *body.grid.find_cell({1, 1, 1});
      for (int v = 0; v < 8; ++v) {
        const auto rule = material_rule(body.grid, body.cuts, cell, 1u << v, 5);
        EXPECT_LT(distance(octant_moments(body.grid, body.cuts, cell, 1u << v), by_quadrature(rule)), 1e-14);
      }
    }
}

} // namespace
} // namespace kerf::fem
