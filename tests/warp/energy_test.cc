#include "warp/energy.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace kerf::warp::energy_test {
namespace {

image::Grey waves(const double phase) {
  image::Grey grey(30, 22, 0);
  for (int r = 0; r < 22; ++r)
    for (int c = 0; c < 30; ++c)
      grey(c, r) = static_cast<float>(std::sin(0.31 * c + phase) * std::cos(0.23 * r - phase));
  return grey;
}

LatticeMap shaken(const double by) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> step(-by, by);
  return lattice_of([&](const Vec2& p) { return Vec2(p + Vec2(step(random), step(random))); }, Vec2::Zero(),
                    Vec2(29, 21), 6, 5);
}

struct Case {
  Regularity regularity;
  Border border;
  double shake;
};

class EnergyGradient : public testing::TestWithParam<Case> {};

TEST_P(EnergyGradient, IsTheDerivative) {
  const FeatureLevel level{{waves(0), waves(1)}, {waves(0.2), waves(1.3)}};
  EnergyOptions options;
  options.regularity = GetParam().regularity;
  options.border = GetParam().border;
  const LatticeMap map = shaken(GetParam().shake);
  ASSERT_GT(smallest_determinant(map), 0);
  Energy energy(map, &level, {{Vec2(4, 5), Vec2(6, 4)}, {Vec2(20, 11), Vec2(19, 13)}}, options);
  Mat2 global;
  global << 0.9, -0.2, 0.2, 0.9;
  energy.take_out(global);
  const Eigen::VectorXd x = to_unknowns(map);
  Eigen::VectorXd gradient, ignored;
  energy(x, gradient);
  // Pixels' interpolation has kinks, and the samples are single: the sum of many is smooth to this step.
  const double step = 1e-4;
  double largest = 0;
  for (int i = 0; i < x.size(); ++i) {
    Eigen::VectorXd ahead = x, behind = x;
    ahead[i] += step;
    behind[i] -= step;
    const double slope = (energy(ahead, ignored) - energy(behind, ignored)) / (2 * step);
    if (gradient[i] != 0) {
      EXPECT_NEAR(gradient[i], slope, 2e-4 * gradient.cwiseAbs().maxCoeff()) << i;
      largest = std::max(largest, std::abs(slope));
    }
  }
  EXPECT_GT(largest, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(All, EnergyGradient,
                         testing::Values(Case{Regularity::jacobian, Border::free, 0.8},
                                         Case{Regularity::rigid, Border::free, 0.8},
                                         Case{Regularity::jacobian, Border::slides, 0.8},
                                         Case{Regularity::rigid, Border::free, 1.7}));

TEST(Energy, FlippedTrianglesCostInfinitelyMuch) {
  LatticeMap map = shaken(0);
  Energy energy(map, nullptr, {}, {});
  Eigen::VectorXd gradient;
  EXPECT_NEAR(energy(to_unknowns(map), gradient), 0, 1e-20);
  map.nodes[7][0] += 6.5; // past its neighbour, 5.8 away
  EXPECT_TRUE(std::isinf(energy(to_unknowns(map), gradient)));
}

TEST(Energy, RotationsCostNothingWhenRigid) {
  const auto turned = [](const Vec2& p) {
    Mat2 r;
    r << std::cos(0.7), -std::sin(0.7), std::sin(0.7), std::cos(0.7);
    return Vec2(r * p);
  };
  const LatticeMap map = lattice_of(turned, Vec2::Zero(), Vec2(29, 21), 6, 5);
  Eigen::VectorXd gradient;
  EnergyOptions options;
  options.border = Border::free;
  EXPECT_GT(Energy(map, nullptr, {}, options)(to_unknowns(map), gradient), 1e-3);
  options.regularity = Regularity::rigid;
  EXPECT_NEAR(Energy(map, nullptr, {}, options)(to_unknowns(map), gradient), 0, 1e-12);
}

} // namespace
} // namespace kerf::warp::energy_test
