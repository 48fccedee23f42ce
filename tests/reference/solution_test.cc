// Solutions on fitted meshes against closed forms.

#include "reference/solution.h"

#include "base/error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace kerf::reference::solution_test {
namespace {

using std::numbers::pi;

const Region everywhere = [](const Vec3&) { return true; };
Region at(const int axis, const double value) {
  return [=](const Vec3& X) { return std::abs(X[axis] - value) < 1e-9; };
}

/// u = (sin x sinh y, cos x cosh y, z^2 y) / 4 in a block, held at its skin; what force keeps it there follows from
/// Hooke's law.
Vec3 wave(const Vec3& X) {
  return Vec3(std::sin(X[0]) * std::sinh(X[1]), std::cos(X[0]) * std::cosh(X[1]), X[2] * X[2] * X[1]) / 4;
}

/// -div sigma = -(lambda + mu) grad div u - mu laplace u, by hand. div u = (2 cos x sinh y + 2 z y) / 4.
Field force_of_wave(const double lambda, const double mu) {
  return [=](const Vec3& X) {
    const Vec3 grad_div(-2 * std::sin(X[0]) * std::sinh(X[1]), 2 * std::cos(X[0]) * std::cosh(X[1]) + 2 * X[2],
                        2 * X[1]);
    const Vec3 laplace(0, 0, 2 * X[1]);
    return Vec3(-((lambda + mu) * grad_div + mu * laplace) / 4);
  };
}

/// The block is skewed, so that no cell is a cube.
Problem wave_in_a_block() {
  Problem p;
  p.mesh = extruded(rectangles(equal(0, 1, 1), equal(0, 1, 1)), equal(0, 1, 1));
  map_vertices(p.mesh, [](const Vec3& X) { return Vec3(X[0] + 0.2 * X[1], X[1] - 0.1 * X[2] * X[0], X[2]); });
  p.poissons_ratio = 0.25;
  p.supports = {{everywhere, {true, true, true}, wave}};
  p.body_force = force_of_wave(0.4, 0.4);
  return p;
}

TEST(Solution, HasOrderDegreePlusOneInABlock) {
  const Problem p = wave_in_a_block();
  for (const int degree : {1, 2, 3, 4}) {
    const int finest = degree < 3 ? 3 : 2;
    const double before = solve(p, {degree, finest - 1})->distance_to(wave);
    const double after = solve(p, {degree, finest})->distance_to(wave);
    EXPECT_NEAR(std::log2(before / after), degree + 1, 0.25) << degree;
  }
}

TEST(Solution, HasOrderDegreePlusOneInThePlane) {
  Problem p;
  p.mesh = rectangles(equal(0, 1, 2), equal(0, 1, 2));
  p.poissons_ratio = 0.25;
  const Field plane = [](const Vec3& X) { return Vec3(wave(Vec3(X[0], X[1], 0))); };
  p.supports = {{everywhere, {true, true, true}, plane}};
  p.body_force = [](const Vec3& X) { return force_of_wave(0.4, 0.4)(Vec3(X[0], X[1], 0)); };
  for (const int degree : {1, 2, 3, 4}) {
    const double before = solve(p, {degree, 2})->distance_to(plane), after = solve(p, {degree, 3})->distance_to(plane);
    EXPECT_NEAR(std::log2(before / after), degree + 1, 0.2) << degree;
  }
}

/// The same in a cylinder, whose core, rings and mantle are curved.
TEST(Solution, HasOrderDegreePlusOneInACylinder) {
  Problem p = wave_in_a_block();
  p.mesh = extruded(disc({0.6, 1}), equal(0, 1, 1));
  for (const int degree : {1, 2, 3}) {
    const int finest = degree == 3 ? 1 : 2;
    const double before = solve(p, {degree, finest - 1})->distance_to(wave);
    const double after = solve(p, {degree, finest})->distance_to(wave);
    EXPECT_NEAR(std::log2(before / after), degree + 1, 0.3) << degree;
  }
}

/// A cylinder twisted by tractions at its end: u = theta z (-y, x, 0), with the mantle free.
TEST(Solution, TwistsACylinder) {
  const double theta = 0.3, length = 2, mu = 1 / 2.6;
  const Field twist = [=](const Vec3& X) { return Vec3(-theta * X[2] * X[1], theta * X[2] * X[0], 0); };
  Problem p;
  p.mesh = extruded(disc({0.5, 1}), equal(0, length, 1));
  p.poissons_ratio = 0.3;
  p.supports = {{at(2, 0)}};
  p.tractions = {{at(2, length), [=](const Vec3& X, const Vec3&) { return Vec3(mu * theta * Vec3(-X[1], X[0], 0)); }}};
  const auto found = solve(p, {3, 0});
  EXPECT_LT(found->distance_to(twist), 1e-4);
  EXPECT_NEAR(found->energy() / (mu * theta * theta * length * pi / 4), 1, 1e-5) << "as round as the mapping makes it";
}

/// A linear displacement is found exactly, with hanging nodes too, and with cracks along which nothing pulls.
TEST(Solution, PassesThePatchTestWithHangingNodes) {
  Problem p;
  p.mesh = extruded(rectangles(equal(0, 2, 2), equal(0, 1, 1)), equal(0, 2, 2));
  split(p.mesh, Vec3(0, 0, 1), Vec3::UnitZ(), [](const Vec3& X) { return X[0] <= 1; });
  p.poissons_ratio = 0.3;
  // stress sigma_xx = 1 alone
  const Field stretch = [](const Vec3& X) { return Vec3(X[0], -0.3 * X[1], -0.3 * X[2]); };
  p.supports = {{at(0, 0), {true, true, true}, stretch}};
  p.tractions = {{at(0, 2), [](const Vec3&, const Vec3& n) { return n; }}};
  const auto found = solve(p, {2, 0, 2, 0.4});
  EXPECT_GT(found->n_unknowns(), solve(p, {2, 0})->n_unknowns());
  EXPECT_LT(found->distance_to(stretch), 1e-12);
  EXPECT_NEAR(found->energy(), 0.5 * 1 * 4, 1e-12);
  EXPECT_LT((found->displacement(Vec3(1.3, 0.4, 0.9)) - stretch(Vec3(1.3, 0.4, 0.9))).norm(), 1e-12);
}

TEST(Solution, RefusesWhatCannotBeSolved) {
  Problem p = wave_in_a_block();
  EXPECT_THROW(solve(p, {5, 0}), ParameterError);
  EXPECT_THROW(solve(p, {1, 0})->displacement(Vec3(3, 3, 3)), DataError);
  p.supports[0].where = at(0, 7);
  EXPECT_THROW(solve(p, {1, 0}), ParameterError);
  p.supports.clear();
  EXPECT_THROW(solve(p, {1, 1}), NumericalError) << "free to move";
  p.poissons_ratio = 0.5;
  EXPECT_THROW(solve(p, {1, 0}), ParameterError);
}

} // namespace
} // namespace kerf::reference::solution_test
