// Motion on fitted meshes against closed forms: waves in a bar, modes, damping.

#include "reference/motion.h"

#include "base/error.h"
#include "tests/reference/problems.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace kerf::reference::motion_test {
namespace {

using std::numbers::pi;

/// A bar of length 1 along x, held at x = 0, in which waves take a second from end to end; nu = 0.
Problem bar(const int n) {
  Problem p;
  p.mesh = rectangles(equal(0, 1, n), equal(0, 0.1, 1));
  p.youngs_modulus = 1000;
  p.density = 1000;
  p.supports = {{at(0, 0), {true, false, false}}, {at(1, 0), {false, true, false}}};
  return p;
}

/// Modal superposition: g_k / w_k^2 (1 - cos w_k t) sin(b_k x), b_k = w_k = (2 k - 1) pi / 2, g_k = 2 g / b_k.
double hanging(const double x, const double t) {
  double sum = 0;
  for (int k = 1; k <= 400; ++k) {
    const double b = (2 * k - 1) * pi / 2;
    sum += 2 / (b * b * b) * (1 - std::cos(b * t)) * std::sin(b * x);
  }
  return sum;
}

TEST(Motion, OfABarThatSuddenlyHangsIsThatOfItsModes) {
  Problem p = bar(8);
  p.body_force = [](const Vec3&) { return Vec3(1000, 0, 0); };
  const auto u = motion(p, {3}, {0.01, 400}, {Vec3(1, 0.05, 0), Vec3(0.5, 0, 0)});
  ASSERT_EQ(u.size(), 401u);
  for (std::size_t i = 0; i < u.size(); ++i) {
    EXPECT_NEAR(u[i][0][0], hanging(1, 0.01 * double(i)), 2e-3) << i;
    EXPECT_NEAR(u[i][1][0], hanging(0.5, 0.01 * double(i)), 2e-3) << i;
    EXPECT_NEAR(u[i][0][1], 0, 1e-9) << "nu = 0";
  }
  EXPECT_NEAR(u[200][0][0], 1, 1e-3) << "twice as far as it would rest, after two ways of the wave";
}

/// The first mode alone, of frequency 1/4 per second: second order in the time step, with its energy and without.
TEST(Motion, OfAModeHasOrderTwo) {
  const Beginning first{[](const Vec3& X) { return Vec3(std::sin(pi / 2 * X[0]), 0, 0); }};
  for (const double radius : {1.0, 0.5}) {
    const auto error = [&](const int n) {
      return std::abs(motion(bar(4), {4}, {3.5 / n, n, 0, radius}, {Vec3(1, 0, 0)}, first).back()[0][0] -
                      std::cos(pi / 2 * 3.5));
    };
    EXPECT_NEAR(std::log2(error(50) / error(100)), 2, 0.1) << radius;
    EXPECT_LT(error(400), 2e-4) << radius;
  }
}

/// c M slows a mode as c/2 does a pendulum: exp(-c t / 2), at the frequency sqrt(w^2 - c^2 / 4).
TEST(Motion, DiesAwayWithMassDamping) {
  const double c = 0.4, w = std::sqrt(pi * pi / 4 - c * c / 4), t = 4;
  const Beginning first{[](const Vec3& X) { return Vec3(std::sin(pi / 2 * X[0]), 0, 0); },
                        [&](const Vec3& X) { return Vec3(-c / 2 * std::sin(pi / 2 * X[0]), 0, 0); }};
  const auto u = motion(bar(4), {4}, {t / 400, 400, c}, {Vec3(1, 0, 0)}, first);
  EXPECT_NEAR(u.back()[0][0], std::exp(-c * t / 2) * std::cos(w * t), 2e-4);
}

/// A cantilever swings at its first frequency of bending, with hanging nodes and three dimensions too.
TEST(Motion, OfACantileverHasItsFrequency) {
  Problem p;
  p.mesh = extruded(rectangles(equal(0, 1, 4), equal(0, 0.1, 1)), equal(0, 0.1, 1));
  p.youngs_modulus = 1e6;
  p.density = 1000;
  p.supports = {{at(0, 0)}};
  p.body_force = [](const Vec3&) { return Vec3(0, -1, 0); };
  const double f = lowest_frequencies(p, {3}, 1).front();
  const int n = 200; // a period
  const auto u = motion(p, {2, 0, 1, 0.3}, {1 / (f * n), n}, {Vec3(1, 0.05, 0.05)});
  const double rest = solve(p, {3})->displacement(Vec3(1, 0.05, 0.05))[1];
  EXPECT_NEAR(u[n / 2][0][1] / rest, 2, 0.06) << "higher modes take a part";
  EXPECT_NEAR(u[n][0][1] / rest, 0, 0.06);
}

TEST(Motion, RefusesWhatCannotBe) {
  EXPECT_THROW(motion(bar(1), {1}, {0, 1}, {}), ParameterError);
  EXPECT_THROW(motion(bar(1), {1}, {1, 1, 0, 2}, {}), ParameterError);
  EXPECT_THROW(motion(bar(1), {1}, {1, 1}, {Vec3(3, 0, 0)}), DataError);
  Problem moved = bar(1);
  moved.supports[0].displacement = [](const Vec3&) { return Vec3(1, 0, 0); };
  EXPECT_THROW(motion(moved, {1}, {1, 1}, {}), ParameterError);
}

/// Two pins instead of a side hold a plate that is drawn from both ends, and leave it free to contract.
TEST(Pins, HoldWhatNothingPullsAt) {
  Problem p;
  p.mesh = rectangles(equal(0, 2, 2), equal(0, 1, 2));
  p.pins = {{Vec3(0, 0, 0)}, {Vec3(2, 0, 0), {false, true, false}}};
  p.tractions = {{at(0, 2), [](const Vec3&, const Vec3& n) { return n; }},
                 {at(0, 0), [](const Vec3&, const Vec3& n) { return n; }}};
  p.poissons_ratio = 0.25;
  const double E = 1 / (1 - 0.25 * 0.25), nu = 0.25 / 0.75; // in plane strain
  EXPECT_LT((solve(p, {2})->displacement(Vec3(2, 1, 0)) - Vec3(2 / E, -nu / E, 0)).norm(), 1e-9);
}

} // namespace
} // namespace kerf::reference::motion_test
