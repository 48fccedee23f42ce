/// Frequencies of bars against closed forms, error against the spacing, and what the stabilisation does to them.

#include "tests/pba/modes.h"

#include <gtest/gtest.h>

namespace kerf::pba::bar_test {
namespace {

const material::Elastic plain{.density = 1000, .youngs_modulus = 1e5, .poissons_ratio = 0};

struct Setting {
  double jitter = 0;
  ModelOptions options = {};
  int n_neighbours = 30;
};

/// Error of the first longitudinal frequency of a free bar of 1 x 0.2 x 0.2 m, c / (2 L), with n phyxels across.
double error_of_bar(const int n, const Setting& setting) {
  Draw draw(1);
  const Points rest = grid_points({5 * n, n, n}, 0.2 / n, setting.jitter, draw);
  const PhyxelModel model(make_phyxels(rest, 0.04, setting.n_neighbours), plain, setting.options);
  Points shape;
  for (const Vec3& p : rest)
    shape.push_back(Vec3(std::cos(M_PI * p[0]), 0, 0));
  const double expected = std::sqrt(plain.youngs_modulus / plain.density) / 2;
  return lowest_frequency(model, std::vector<std::uint8_t>(rest.size(), 0), shape) / expected - 1;
}

/// Error of the first bending frequency of a cantilever of 0.6 x 0.1 x 0.1 m, held in two more layers, against
/// Euler and Bernoulli's corrected for shear and rotary inertia by Southwell and Dunkerley's sum.
double error_of_cantilever(const int n, const Setting& setting) {
  Draw draw(1);
  const double height = 0.1, length = 0.6, s = height / n;
  Points rest = grid_points({6 * n + 2, n, n}, s, setting.jitter, draw), shape;
  std::vector<std::uint8_t> held;
  for (Vec3& p : rest) {
    p[0] -= 2 * s;
    held.push_back(p[0] < 0);
    shape.push_back(Vec3(0, 0, p[0] * p[0]));
  }
  const PhyxelModel model(make_phyxels(rest, s * s * s * static_cast<double>(rest.size()), setting.n_neighbours), plain,
                          setting.options);
  const double bending =
    1.8751 * 1.8751 / (2 * M_PI * length * length) * std::sqrt(plain.youngs_modulus / plain.density / 12) * height;
  const double shear = std::sqrt(5.0 / 6 * plain.mu() / plain.density) / (4 * length);
  const double expected = 1 / std::sqrt(1 / (bending * bending) + 1 / (shear * shear));
  return lowest_frequency(model, held, shape) / expected - 1;
}

TEST(Bar, LongitudinalFrequencyConvergesToTheClosedForm) {
  double errors[3];
  for (const int n : {2, 4, 6}) {
    errors[n / 2 - 1] = error_of_bar(n, {});
    record(std::to_string(n) + " across", errors[n / 2 - 1]);
  }
  EXPECT_LT(std::abs(errors[1]), 0.7 * std::abs(errors[0]));
  EXPECT_LT(std::abs(errors[2]), 0.7 * std::abs(errors[1]));
  EXPECT_LT(std::abs(errors[2]), 0.001);
}

TEST(Bar, CantileverFrequencyConvergesToTheClosedForm) {
  for (const double jitter : {0.0, 0.5}) {
    double errors[3];
    for (const int n : {2, 4, 6}) {
      errors[n / 2 - 1] = error_of_cantilever(n, {.jitter = jitter});
      record("jitter " + to_text(jitter) + ", " + std::to_string(n) + " across", errors[n / 2 - 1]);
    }
    EXPECT_LT(std::abs(errors[1]), 0.3 * std::abs(errors[0]));
    EXPECT_LT(std::abs(errors[2]), 0.5 * std::abs(errors[1]));
    EXPECT_LT(std::abs(errors[2]), 0.02);
  }
}

/// Without stabilisation the mode of a bar is lost among modes that cost nothing; a little brings it back, and more
/// changes it little.
TEST(Bar, StabilisationRemovesZeroEnergyModes) {
  const double without = error_of_bar(4, {.options = {.stabilisation = 0}});
  record("without", without);
  for (const double c : {0.1, 0.3, 1.0}) {
    const double with = error_of_bar(4, {.options = {.stabilisation = c}});
    record("stabilisation " + to_text(c), with);
    EXPECT_LT(std::abs(with), 0.01);
  }
  EXPECT_LT(without, -0.2);
}

/// The wave of the shortest length on a lattice: gradients inside see nothing of it.
TEST(Bar, StabilisationSeesTheShortestWave) {
  Draw draw(2);
  const Points rest = grid_points({12, 12, 12}, 0.1, 0, draw);
  Points x = rest;
  const double size = 1e-4;
  for (std::size_t i = 0; i < x.size(); ++i) // inside, far from the faces, where gradients are symmetric
    if ((rest[i] - Vec3::Constant(0.6)).cwiseAbs().maxCoeff() < 0.2)
      x[i][0] += (i % 12 + i / 12 % 12 + i / 144) % 2 == 0 ? size : -size;
  double energies[2];
  for (const double c : {0.0, 1.0})
    energies[c > 0] = PhyxelModel(make_phyxels(rest, 1.728, 30), plain, {.stabilisation = c}).energy(x);
  record("without over with", energies[0] / energies[1]);
  EXPECT_GT(energies[1], 50 * energies[0]);
}

} // namespace
} // namespace kerf::pba::bar_test
