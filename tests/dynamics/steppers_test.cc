/// What holds for every integrator, against closed forms.

#include "base/error.h"
#include "dynamics/implicit_euler.h"
#include "dynamics/symplectic_euler.h"
#include "tests/dynamics/chain.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>

namespace kerf::dynamics::steppers_test {
namespace {

constexpr ImplicitEulerOptions tight{.n_newton = 1, .cg_tolerance = 1e-14, .max_cg_iterations = 2000};

class Steppers : public testing::TestWithParam<std::string> {
 protected:
  static std::unique_ptr<Stepper> make(ElasticModel& model) {
    if (GetParam() == "implicit")
      return std::make_unique<ImplicitEuler>(model, tight);
    return std::make_unique<SymplecticEuler>(model);
  }

  static void run(ElasticModel& model, State& state, const Loads& loads, const double dt, const int n) {
    const auto stepper = make(model);
    for (int i = 0; i < n; ++i)
      stepper->step(state, loads, dt);
  }
};

/// One mass on a spring, with both kinds of damping: x(1.5) against the closed form, in four time steps.
TEST_P(Steppers, AreOfFirstOrder) {
  const double m = 2, k = 50, alpha = 0.3, beta = 0.01, end = 1.5, x0 = 0.1, v0 = -0.4;
  const double decay = 0.5 * (alpha + beta * k / m), omega = std::sqrt(k / m - decay * decay);
  const double exact =
    std::exp(-decay * end) * (x0 * std::cos(omega * end) + (v0 + decay * x0) / omega * std::sin(omega * end));
  double before = 0;
  for (const int n : {400, 800, 1600, 3200}) {
    Chain model({m}, {.anchor = k});
    State state = model.state();
    state.x[0][1] += x0;
    state.v[0][1] = v0;
    run(model, state, {.mass_damping = alpha, .stiffness_damping = beta, .supports = {}}, end / n, n);
    const double error = std::abs(state.x[0][1] - exact);
    if (before > 0) {
      EXPECT_NEAR(std::log2(before / error), 1, 0.2) << n;
      RecordProperty("rate_" + std::to_string(n), std::to_string(std::log2(before / error)));
    }
    before = error;
    EXPECT_NEAR(state.time, end, 1e-12);
  }
  EXPECT_LT(before, 1e-3);
}

TEST_P(Steppers, FreeFallIsExactToTheScheme) {
  Chain model({1, 2, 0.5}, {.neighbour = 10});
  State state = model.state();
  const double dt = 0.01;
  const int n = 100;
  const Vec3 g(0.1, -0.2, -9.81);
  run(model, state, {.gravity = g, .supports = {}}, dt, n);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_LT((state.v[i] - n * dt * g).norm(), 1e-11);
    EXPECT_LT((state.x[i] - model.rest()[i] - 0.5 * n * (n + 1) * dt * dt * g).norm(), 1e-11);
  }
}

TEST_P(Steppers, MassDampingSlowsEveryMassAlike) {
  Chain model({1, 5}, {.neighbour = 10});
  State state = model.state();
  for (Vec3& v : state.v)
    v = Vec3(1, 2, 3);
  run(model, state, {.mass_damping = 2, .supports = {}}, 0.1, 10);
  for (const Vec3& v : state.v)
    EXPECT_LT((v - std::pow(1.2, -10) * Vec3(1, 2, 3)).norm(), 1e-12);
}

TEST_P(Steppers, StiffnessDampingStopsVibrationNotFlight) {
  Chain model({1, 1}, {.neighbour = 100});
  State state = model.state();
  state.v = {Vec3(1, 1, 0), Vec3(1, -1, 0)};
  run(model, state, {.stiffness_damping = 0.02, .supports = {}}, 1e-3, 20000);
  for (const Vec3& v : state.v)
    EXPECT_LT((v - Vec3::UnitX()).norm(), 1e-6);
  EXPECT_LT(model.energy(state.x), 1e-10);
}

/// The middle of three is free, the ends follow their own ways.
TEST_P(Steppers, SupportsGoWhereTheyAreTold) {
  Chain model({1, 1, 1}, {.anchor = 1, .neighbour = 100});
  State state = model.state();
  const auto way = [](const double t) { return Vec3(std::sin(t), t * t, 0); };
  Loads loads{.gravity = Vec3(0, 0, -1), .stiffness_damping = 0.01, .supports = {}};
  loads.supports = {{{0}, {model.rest()[0]}, way}, {{2}, {model.rest()[2]}, [](double) { return Vec3::Zero(); }}};
  const auto stepper = make(model);
  const double dt = 0.01;
  for (int i = 0; i < 50; ++i) {
    stepper->step(state, loads, dt);
    const double t = (i + 1) * dt;
    EXPECT_LT((state.x[0] - model.rest()[0] - way(t)).norm(), 1e-14);
    EXPECT_LT((state.v[0] - (way(t) - way(t - dt)) / dt).norm(), 1e-11);
    EXPECT_EQ(state.x[2], model.rest()[2]);
    EXPECT_EQ(state.v[2], Vec3::Zero());
  }
  EXPECT_LT(state.x[1][2], -1e-3);
  EXPECT_GT(state.x[1][1], 1e-3);
}

TEST_P(Steppers, AMassUnderTwoSupportsHasItsVelocity) {
  Chain model({1}, {.anchor = 1});
  State state = model.state();
  const Support support{{0}, {model.rest()[0]}, [](const double t) { return Vec3(2 * t, 0, 0); }};
  Loads loads;
  loads.supports = {support, support};
  make(model)->step(state, loads, 0.1);
  EXPECT_NEAR(state.x[0][0], 0.2, 1e-15);
  EXPECT_NEAR(state.v[0][0], 2, 1e-14);
}

TEST_P(Steppers, KeepMomentumInFreeFlight) {
  const std::vector<double> mass = {1, 0.3, 2, 0.7, 1.1};
  Chain model(mass, {.neighbour = 30});
  State state = model.state();
  const auto momentum = [&] {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < mass.size(); ++i)
      sum += mass[i] * state.v[i];
    return sum;
  };
  for (std::size_t i = 0; i < mass.size(); ++i)
    state.v[i] = Vec3(0.1 * static_cast<double>(i), i == 2 ? 3 : 0, -0.5);
  const Vec3 before = momentum();
  run(model, state, {}, 0.02, 500);
  EXPECT_LT((momentum() - before).norm(), 1e-11 * before.norm());
}

TEST_P(Steppers, GoOnFromACarriedState) {
  Chain model({1, 2}, {.anchor = 3, .cubic = 20, .neighbour = 30});
  State once = model.state();
  once.v[0] = Vec3(1, 2, 3);
  State twice = once;
  run(model, once, {}, 0.01, 20);
  run(model, twice, {}, 0.01, 12);
  run(model, twice, {}, 0.01, 8);
  EXPECT_EQ(once.x, twice.x);
  EXPECT_EQ(once.v, twice.v);
}

TEST_P(Steppers, RefuseForcesThatAreNotFinite) {
  Chain model({1, 1}, {.anchor = 1});
  State state = model.state();
  state.x[1][0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(make(model)->step(state, {}, 0.01), NumericalError);
}

INSTANTIATE_TEST_SUITE_P(Euler, Steppers, testing::Values("implicit", "symplectic"),
                         [](const auto& info) { return info.param; });

} // namespace
} // namespace kerf::dynamics::steppers_test
