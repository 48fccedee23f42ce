// Modes of vibration of a row of masses: closed forms, several of one frequency, and a dense solver.

#include "dynamics/modal.h"

#include "base/error.h"
#include "dynamics/points.h"
#include "tests/dynamics/chain.h"

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include <numbers>
#include <random>

namespace kerf::dynamics::modal_test {
namespace {

constexpr double k = 50, m = 0.2; // [N/m], [kg]
constexpr int n = 12;

Modes modes_of(Chain& chain, const Loads& loads, const int n_modes) {
  int n_iterations = 0;
  const Modes modes =
    lowest_modes(chain, loads, 0, chain.rest(), {.n_modes = n_modes, .cg_tolerance = 1e-13}, n_iterations);
  EXPECT_GT(n_iterations, 0);
  return modes;
}

Support held(const Chain& chain, const std::uint32_t corner, const Mat3& along) {
  return {{corner}, {chain.rest()[corner]}, [](double) { return Vec3(Vec3::Zero()); }, {}, along};
}

double hertz(const double angular) { return angular / (2 * std::numbers::pi); }

/// 2 sqrt(k / m) sin(j pi / (2 n)), the same along x, y and z.
TEST(Modal, FindsEachOfThreeModesOfOneFrequency) {
  Chain chain(std::vector<double>(n, m), {.neighbour = k});
  const Modes modes = modes_of(chain, {}, 10);
  ASSERT_EQ(modes.frequencies.size(), 10u);
  for (int i = 0; i < 10; ++i)
    EXPECT_NEAR(modes.frequencies[i], hertz(2 * std::sqrt(k / m) * std::sin((i / 3) * std::numbers::pi / (2 * n))),
                1e-6)
      << i;
}

/// A row that is held at its end along x, and floats across.
TEST(Modal, ObeysSupports) {
  Chain chain(std::vector<double>(n, m), {.neighbour = k});
  Loads loads;
  Mat3 along_x = Mat3::Zero();
  along_x(0, 0) = 1;
  loads.supports.push_back(held(chain, 0, along_x));
  const Modes modes = modes_of(chain, loads, 5);
  const double first = 2 * std::sqrt(k / m) * std::sin(std::numbers::pi / (2 * (2 * n - 1))), // a row of n - 1
    across = 2 * std::sqrt(k / m) * std::sin(std::numbers::pi / (2 * n));
  const std::vector<double> expected = {0, 0, first, across, across};
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_NEAR(modes.frequencies[i], hertz(expected[i]), 1e-6) << i;
  EXPECT_EQ(modes.shapes[2][0][0], 0);
  EXPECT_NEAR((modes.shapes[2][n - 1] - Vec3::UnitX()).norm(), 0, 1e-6); // the free end moves most, by 1
}

/// Masses from 1e-3 to 1 kg, drawn to their places: the values and the vectors of a dense solver.
TEST(Modal, AreThoseOfADenseSolver) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> exponent(-3, 0);
  std::vector<double> mass;
  for (int i = 0; i < n; ++i)
    mass.push_back(std::pow(10, exponent(random)));
  Chain chain(mass, {.anchor = 3, .neighbour = k, .weights = {1, 0.5, 0.1}});
  Loads loads;
  loads.supports.push_back(held(chain, 4, Mat3::Identity()));
  const Modes modes = modes_of(chain, loads, 8);
  chain.linearise(chain.rest());
  std::vector<int> free;
  for (int j = 0; j < 3 * n; ++j)
    if (j / 3 != 4)
      free.push_back(j);
  Eigen::MatrixXd K(3 * n, 3 * n), M = Eigen::MatrixXd::Zero(3 * n, 3 * n);
  for (int j = 0; j < 3 * n; ++j) {
    const Eigen::VectorXd e = Eigen::VectorXd::Unit(3 * n, j);
    chain.apply_stiffness({e.data(), std::size_t(3 * n)}, {K.col(j).data(), std::size_t(3 * n)});
    M(j, j) = mass[j / 3];
  }
  const Eigen::MatrixXd free_K = K(free, free), free_M = M(free, free);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> dense(free_K, free_M);
  for (int i = 0; i < 8; ++i) {
    EXPECT_NEAR(modes.frequencies[i], hertz(std::sqrt(dense.eigenvalues()[i])), 1e-7 * modes.frequencies[i]) << i;
    const Eigen::VectorXd u = Eigen::Map<const Eigen::VectorXd>(modes.shapes[i][0].data(), 3 * n)(free);
    const double cosine = u.dot(free_M * dense.eigenvectors().col(i)) / std::sqrt(u.dot(free_M * u));
    EXPECT_NEAR(std::abs(cosine), 1, 1e-6) << i;
  }
}

TEST(Modal, AStepLeavesTheBodyWhereItIs) {
  Chain chain(std::vector<double>(n, m), {.anchor = 1, .neighbour = k});
  Modal modal(chain, {.n_modes = 2});
  State state = chain.state();
  state.v[3] = Vec3(1, 2, 3);
  const StepReport report = modal.step(state, {}, 0.5);
  EXPECT_EQ(state.x, chain.rest());
  EXPECT_EQ(state.v, Points(n, Vec3::Zero()));
  EXPECT_EQ(state.time, 0.5);
  EXPECT_EQ(report.modes.shapes.size(), 2u);
  EXPECT_NEAR(report.modes.frequencies[0], hertz(std::sqrt(1 / m)), 1e-7);
}

TEST(Modal, MoreModesThanDirectionsAreRefused) {
  Chain chain(std::vector<double>(2, m), {.neighbour = k});
  int n_iterations = 0;
  EXPECT_THROW(lowest_modes(chain, {}, 0, chain.rest(), {.n_modes = 5}, n_iterations), ParameterError);
}

} // namespace
} // namespace kerf::dynamics::modal_test
