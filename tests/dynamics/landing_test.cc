/// Bodies on a floor: they land, rest, stick and slide; with explicit and implicit integrators.

#include "base/error.h"
#include "dynamics/floor.h"
#include "dynamics/forces.h"
#include "dynamics/quantities.h"
#include "dynamics/stable_step.h"
#include "tests/dynamics/chain.h"
#include "tests/dynamics/integrators.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace kerf::dynamics::landing_test {
namespace {

/// Three masses in a row that hold together.
const std::vector<double> masses = {1, 2, 1.5};
constexpr double weight = 4.5 * 9.81;

Chain block() { return Chain(masses, {.neighbour = 2000}); }

ContactPoints all_points() { return {corners_themselves(masses.size()), {0.01, 0.02, 0.015}}; }

void put_on(Loads& loads, const FloorParameters& parameters) {
  auto floor = std::make_unique<Floor>(all_points(), parameters);
  auto friction = std::make_unique<FloorFriction>(*floor);
  loads.acting.push_back(std::move(floor));
  loads.acting.push_back(std::move(friction));
}

class Landing : public testing::TestWithParam<Integrator> {};

/// From 5 cm above, with some damping: in the end the floor carries the weight, at the depth of its stiffness.
TEST_P(Landing, BlockComesToRestOnItsWeight) {
  Chain model = block();
  State state = model.state();
  for (Vec3& x : state.x)
    x += Vec3(0, 0, 0.05);
  Loads loads{.gravity = Vec3(0, 0, -9.81), .mass_damping = 8, .supports = {}};
  put_on(loads, {.stiffness = 2e5, .friction = 0.5});
  const auto stepper = GetParam().make(model);
  for (int i = 0; i < 4000; ++i)
    stepper->step(state, loads, 1e-3);
  const Vec3 reaction = load_force(*loads.acting[0], state);
  EXPECT_NEAR(reaction[2], weight, 1e-6 * weight);
  EXPECT_NEAR(reaction[0], 0, 1e-9);
  for (std::size_t i = 0; i < masses.size(); ++i) {
    EXPECT_NEAR(state.x[i][2], -masses[i] * 9.81 / (2e5 * all_points().areas[i]), 1e-6);
    EXPECT_LT(state.v[i].norm(), 1e-6);
  }
}

/// On a tilted floor, measured along the slope after 1 s.
State slide(const Integrator& integrator, const double angle, const double mu, const double dt = 1e-4) {
  Chain model = block();
  const Vec3 normal(-std::sin(angle), 0, std::cos(angle)), g(0, 0, -9.81);
  Loads loads{.gravity = g, .supports = {}};
  const FloorParameters parameters{.normal = normal, .stiffness = 2e5, .friction = mu, .creep = 1e-3};
  put_on(loads, parameters);
  State state = model.state();
  for (std::size_t i = 0; i < masses.size(); ++i) // in the slope, at rest along the normal
    state.x[i] = 0.1 * static_cast<double>(i) * Vec3::UnitY() -
                 masses[i] * 9.81 * std::cos(angle) / (2e5 * all_points().areas[i]) * normal;
  Chain row(masses, {}); // no springs: the row along y would be drawn to x
  const auto stepper = integrator.make(row);
  for (int i = 0; i < std::lround(1 / dt); ++i)
    stepper->step(state, loads, dt);
  return state;
}

double along_slope(const Vec3& v, const double angle) { return -v.dot(Vec3(std::cos(angle), 0, std::sin(angle))); }

constexpr double degree = std::numbers::pi / 180;

TEST_P(Landing, BlockSticksBelowTheAngleOfFriction) {
  const double mu = 0.5, angle = std::atan(mu) - 3 * degree;
  const State state = slide(GetParam(), angle, mu);
  for (const Vec3& v : state.v) // what sticks creeps, with g(s) = tan(angle) / mu, below the creep velocity
    EXPECT_NEAR(along_slope(v, angle), 1e-3 * (1 - std::sqrt(1 - std::tan(angle) / mu)), 2e-5);
}

TEST_P(Landing, BlockSlidesAboveTheAngleOfFriction) {
  const double mu = 0.5, angle = std::atan(mu) + 3 * degree;
  const State state = slide(GetParam(), angle, mu);
  const double acceleration = 9.81 * (std::sin(angle) - mu * std::cos(angle));
  for (const Vec3& v : state.v)
    EXPECT_NEAR(along_slope(v, angle) / (acceleration * state.time), 1, 1e-2);
}

/// Explicit steps twenty times as long as those that friction's slope at rest asks for, 2 e / (2 mu g): friction is
/// bounded, and does not count. What sticks quivers by what friction gives in a step, and creeps more slowly than that.
TEST(Landing, LongExplicitStepsStickAndSlideToo) {
  constexpr double mu = 0.5, dt = 4e-3, quiver = mu * 9.81 * dt;
  const std::vector<Integrator> watched = {
    {"symplectic Euler", 1, [](ElasticModel& m) { return made<SymplecticEuler>(m, ExplicitOptions{}); }},
    {"velocity Verlet", 2, [](ElasticModel& m) { return made<VelocityVerlet>(m, ExplicitOptions{}); }}};
  for (const Integrator& integrator : watched) {
    const double sticks = std::atan(mu) - 3 * degree, slides = std::atan(mu) + 3 * degree;
    const State still = slide(integrator, sticks, mu, dt), sliding = slide(integrator, slides, mu, dt);
    for (std::size_t i = 0; i < masses.size(); ++i) {
      EXPECT_LT(std::abs(along_slope(still.v[i], sticks)), 2 * quiver) << integrator.name;
      EXPECT_LT(std::abs(along_slope(still.x[i], sticks)), quiver * still.time) << integrator.name;
      EXPECT_NEAR(along_slope(sliding.v[i], slides) / (9.81 * (std::sin(slides) - mu * std::cos(slides))), 1, 5e-2)
        << integrator.name;
    }
  }
}

/// A floor nine times as stiff as what holds a mass: the stable step is found anew when it touches down, and once more
/// some time after it has left.
TEST(Landing, MakesExplicitStepsTooLong) {
  Chain model({1}, {.anchor = 100});
  Loads loads;
  loads.acting.push_back(std::make_unique<Floor>(ContactPoints{corners_themselves(1), {0.01}},
                                                 FloorParameters{.point = Vec3(0, 0, -0.1), .stiffness = 9e4}));
  constexpr double dt = 0.1, in_air = 2 / 10., on_floor = 2 / 31.6227766;
  StepLimit limit(model, VelocityVerlet::scheme(), {});
  State above = model.state(), below = above;
  limit.require(above, loads, dt, above.numbers);
  EXPECT_NEAR(limit.last(), in_air, 1e-3 * in_air);
  below.numbers = above.numbers;
  below.x[0][2] = -0.11;
  EXPECT_THROW(limit.require(below, loads, dt, below.numbers), NumericalError);
  EXPECT_NEAR(limit.last(), on_floor, 1e-3 * on_floor);
  EXPECT_NO_THROW(limit.require(below, loads, dt / 2, below.numbers));
  int n = 0;
  for (bool is_long = true; is_long; ++n)
    try {
      limit.require(above, loads, dt, above.numbers);
      is_long = false;
    } catch (const NumericalError&) {
    }
  EXPECT_NEAR(n, 200, 2);
  EXPECT_NEAR(limit.last(), in_air, 1e-3 * in_air);
}

INSTANTIATE_TEST_SUITE_P(Integrators, Landing,
                         testing::Values(integrators()[1], integrators()[2], integrators()[3], integrators()[4],
                                         integrators()[8], integrators()[10]),
                         [](const auto& info) { return info.param.name; });

/// A long step of implicit Euler lands without a bounce and without sinking through.
TEST(Landing, LongImplicitStepsLandToo) {
  Chain model = block();
  State state = model.state();
  for (Vec3& x : state.x)
    x += Vec3(0, 0, 0.3);
  Loads loads{.gravity = Vec3(0, 0, -9.81), .supports = {}};
  put_on(loads, {.stiffness = 1e7, .friction = 0.5});
  ImplicitEuler stepper(
    model, {.n_newton = 50, .cg_tolerance = 1e-10, .newton_tolerance = 1e-9, .line_search = LineSearch::backtracking});
  for (int i = 0; i < 240; ++i)
    stepper.step(state, loads, 1.0 / 60);
  EXPECT_NEAR(load_force(*loads.acting[0], state)[2], weight, 1e-4 * weight);
  for (const Vec3& x : state.x)
    EXPECT_GT(x[2], -1e-3);
}

/// Energy of a block that slides to a stop: what was there is dissipated, none is gained.
TEST(Landing, FrictionBooksWhatItTakes) {
  Chain model = block();
  State state = model.state();
  Loads loads{.gravity = Vec3(0, 0, -9.81), .supports = {}};
  put_on(loads, {.stiffness = 2e5, .friction = 0.3});
  for (std::size_t i = 0; i < masses.size(); ++i) {
    state.x[i][2] = -masses[i] * 9.81 / (2e5 * all_points().areas[i]);
    state.v[i] = Vec3(0, 0.8, 0);
  }
  const auto energy = [&](const State& s) {
    return kinetic_energy(model, s.v) + model.energy(s.x) + gravity_energy(model, loads, s.x) +
           load_energy(loads, s.time, s.x);
  };
  const double before = energy(state);
  VelocityVerlet stepper(model, go_on);
  Points still(masses.size(), Vec3::Zero());
  for (int i = 0; i < 20000; ++i) {
    const Power begin = power(model, loads, state, still);
    stepper.step(state, loads, 5e-5);
    book(begin, power(model, loads, state, still), 5e-5, state);
  }
  EXPECT_LT(kinetic_energy(model, state.v), 1e-3);
  EXPECT_NEAR(state.numbers.at("dissipated energy [J]"), 0.5 * 4.5 * 0.64, 1e-2);
  EXPECT_NEAR(energy(state) + state.numbers.at("dissipated energy [J]"), before, 1e-4);
}

} // namespace
} // namespace kerf::dynamics::landing_test
