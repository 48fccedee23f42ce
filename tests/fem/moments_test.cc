#include "fem/moments.h"

#include "fem/element.h"
#include "grid/cube.h"
#include "tests/fem/bodies.h"
#include "tests/fem/quadrature.h"
#include "tests/support/placed.h"
#include "tests/support/spectrum.h"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::fem::moments_test {
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
      const Moments m = material_moments(body, body.complex.copies[c]);
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
        const auto rule = material_rule(body, cell, 1u << v, 5);
        EXPECT_LT(distance(octant_moments(body, cell, 1u << v), by_quadrature(rule)), 1e-14);
      }
    }
}

using Products = Eigen::Matrix<double, 8, 8>;

/// Integrals of the products of two shape functions.
Products products_of_shapes(const Moments& m) {
  Products result = Products::Zero();
  for (int a = 0; a < 8; ++a)
    for (int b = 0; b < 8; ++b)
      for (int n = 0; n < 27; ++n) {
        double factor = 1;
        for (int axis = 0, power = n; axis < 3; ++axis, power /= 3) {
          const std::array<double, 2> p = (a >> axis & 1) != 0 ? std::array{0.0, 1.0} : std::array{1.0, -1.0},
                                      q = (b >> axis & 1) != 0 ? std::array{0.0, 1.0} : std::array{1.0, -1.0};
          factor *= std::array{p[0] * q[0], p[0] * q[1] + p[1] * q[0], p[1] * q[1]}[power % 3];
        }
        result(a, b) += factor * m[n];
      }
  return result;
}

double least_square(const Moments& m) { return support::spectrum(products_of_shapes(m))[0]; }

/// Of the box between two corners.
Moments of_box(const Vec3& lower, const Vec3& upper) {
  Moments m;
  for (int n = 0; n < 27; ++n) {
    m[n] = 1;
    for (int axis = 0, power = n; axis < 3; ++axis, power /= 3) {
      const int k = power % 3 + 1;
      m[n] *= (std::pow(upper[axis], k) - std::pow(lower[axis], k)) / k;
    }
  }
  return m;
}

TEST(Moments, LoseNoMoreThanTheirNegativeSquares) {
  const Moments slab = of_box(Vec3::Zero(), {1, 1, 0.2});
  EXPECT_EQ(without_negative_squares(slab), slab);
  // A box less another one that reaches beyond it.
  const Moments outer = of_box(Vec3::Zero(), {0.6, 1, 1}), inner = of_box({0.4, 0, 0}, {0.9, 1, 0.8});
  Moments folded;
  for (int n = 0; n < 27; ++n)
    folded[n] = outer[n] - inner[n];
  ASSERT_LT(least_square(folded), -1e-3);
  const Moments m = without_negative_squares(folded);
  EXPECT_DOUBLE_EQ(m[0], folded[0]);
  EXPECT_NEAR(least_square(m), 0, 1e-15);
}

const material::Elastic unit{.density = 1, .youngs_modulus = 1, .poissons_ratio = 0.3};

/// The largest eigenvalue of an element, by its volume, over that of the whole cube.
double stiffness_by_volume(const Moments& m) {
  const auto stiffest = [](const Moments& moments) {
    return support::spectrum(stiffness(make_element(moments, 1, unit, {}), unit))[23];
  };
  static const double of_cube = stiffest(full_cube_moments());
  return stiffest(m) / (m[0] * of_cube);
}
constexpr double most_by_volume = 8; // 4.8 where all of the material lies in a corner

/// Under a jagged skin that planes have cut: moments are those of material, as another rule finds it, and no element
/// gains energy.
TEST(Moments, MakeElementsThatNeverGainEnergy) {
  support::Random random(4);
  int n_under_skin = 0;
  double least = 0;
  for (int i = 0; i < 240; ++i) {
    const Vec3 offset = 0.5 * (support::random_direction(random) + Vec3::Ones());
    auto body = support::embedded(geometry::sphere_mesh(0.4, Vec3::Constant(0.5), 1), 0.15, offset);
    for (grid::CutLabel label = 1; label <= 3; ++label) {
      const Vec3 normal = support::random_direction(random);
      const Vec3 through = Vec3::Constant(0.5) + 0.2 * support::random_vector(random);
      support::cut_through(body, support::cuts_of_plane(body, {normal, normal.dot(through)}, label));
    }
    const auto complex = grid::build_complex(body);
    for (const grid::Copy& copy : complex.copies) {
      if (copy.skin == 0)
        continue;
      ++n_under_skin;
      const Moments m = material_moments(body, copy);
      least = std::min(least, least_square(m));
      Products products = Products::Zero();
      grid::for_each_tetrahedron(
        body, copy, [&](const grid::Tetrahedron& t, int) { grid::add_shape_products(t, products); });
      products = products.selfadjointView<Eigen::Lower>();
      EXPECT_LT((products - products_of_shapes(m)).cwiseAbs().maxCoeff(), 1e-12);
      EXPECT_LT(stiffness_by_volume(m), most_by_volume);
      for (const Strain strain : {Strain::trilinear, Strain::enhanced})
        EXPECT_GT(support::spectrum(stiffness(make_element(m, 1, unit, {.strain = strain}), unit))[0], -1e-14);
      EXPECT_GT(support::spectrum(consistent_mass(m, 1))[0], -1e-15);
    }
  }
  EXPECT_GT(n_under_skin, 4000);
  EXPECT_GT(least, -1e-14);
}

} // namespace
} // namespace kerf::fem::moments_test
