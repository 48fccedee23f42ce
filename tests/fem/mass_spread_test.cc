#include "fem/element.h"

#include "tests/fem/bodies.h"

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include <numeric>

namespace kerf::fem {
namespace {

const material::Elastic rubber{.density = 1100, .youngs_modulus = 3e4, .poissons_ratio = 0.42};

double total(const Element& element) { return std::accumulate(element.mass.begin(), element.mass.end(), 0.0); }

/// Square of the largest frequency of an element on its own [1/s^2].
double largest_frequency(const Element& element) {
  Eigen::Matrix<double, 24, 1> scale;
  for (int i = 0; i < 24; ++i)
    scale[i] = 1 / std::sqrt(element.mass[i / 3]);
  const Matrix24 K = scale.asDiagonal() * Eigen::Map<const Matrix24>(element.stiffness.data()) * scale.asDiagonal();
  return Eigen::SelfAdjointEigenSolver<Matrix24>(K).eigenvalues()[23];
}

/// Elements of a block whose skin lies at parts `t` beyond its nodes: slivers of t, t^2, t^3 of a cube.
std::vector<Element> skin_elements(const double t, const double spread) {
  Draw draw(1);
  const Body body = make_block({2, 2, 2}, 1, draw, {t, t});
  std::vector<Element> elements;
  for (const grid::Copy& copy : body.complex.copies) {
    elements.push_back(make_element(material_moments(body, copy), 1, rubber, {.sliver_floor = 0}));
    spread_mass(elements.back(), spread);
  }
  return elements;
}

TEST(MassSpread, KeepsTheTotalAndLeavesAFullCubeAlone) {
  const auto before = skin_elements(0.3, 0), after = skin_elements(0.3, 0.4);
  for (std::size_t e = 0; e < before.size(); ++e)
    EXPECT_NEAR(total(after[e]) / total(before[e]), 1, 1e-14);
  Element cube = make_element(full_cube_moments(), 1, rubber, {.sliver_floor = 0});
  spread_mass(cube, 0.4);
  for (const double m : cube.mass)
    EXPECT_NEAR(m / (rubber.density / 8), 1, 1e-14);
}

TEST(MassSpread, BoundsTheFrequencyOfSlivers) {
  const double cube = largest_frequency(make_element(full_cube_moments(), 1, rubber, {.sliver_floor = 0}));
  double bare = 0, worst = 0;
  for (const double t : {0.5, 0.1, 1e-2, 1e-3, 1e-4}) {
    for (const Element& element : skin_elements(t, 0))
      bare = std::max(bare, largest_frequency(element));
    for (const Element& element : skin_elements(t, 0.2))
      worst = std::max(worst, largest_frequency(element));
  }
  EXPECT_GT(bare, 1e3 * cube);
  // A corner has at least a part 0.2 / 8 of the element's mass, and K per mass of material is at most that of a point.
  EXPECT_LT(worst, 40 * cube);
  RecordProperty("frequency ratio", std::to_string(std::sqrt(worst / cube)));
}

} // namespace
} // namespace kerf::fem
