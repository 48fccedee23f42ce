#include "dynamics/symplectic_euler.h"

#include "base/error.h"
#include "tests/dynamics/chain.h"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::dynamics::symplectic_euler_test {
namespace {

const double mass = 2, spring = 50, limit = 2 / std::sqrt(spring / mass); // the longest stable step [s]

double energy(const Chain& model, const State& state) {
  return model.energy(state.x) + 0.5 * mass * state.v[0].squaredNorm();
}

TEST(SymplecticEuler, IsItsOwnFormula) {
  const double alpha = 0.3, beta = 0.02, dt = 0.01;
  Chain model({mass}, {.anchor = spring});
  SymplecticEuler stepper(model);
  State state = model.state();
  state.x[0] += Vec3(0.1, -0.2, 0.3);
  Vec3 x = state.x[0], v = state.v[0];
  for (int i = 0; i < 50; ++i) {
    stepper.step(state, {.mass_damping = alpha, .stiffness_damping = beta, .supports = {}}, dt);
    v = (v - dt * spring / mass * (x + beta * v)) / (1 + dt * alpha);
    x += dt * v;
    EXPECT_LT((state.x[0] - x).norm(), 1e-14);
    EXPECT_LT((state.v[0] - v).norm(), 1e-13);
  }
}

/// Over 16,000 to 300,000 radians.
TEST(SymplecticEuler, EnergyStaysBounded) {
  for (const double part : {0.05, 0.3, 0.9}) {
    Chain model({mass}, {.anchor = spring});
    SymplecticEuler stepper(model);
    State state = model.state();
    state.x[0] += Vec3(0.1, 0, 0);
    const double first = energy(model, state);
    double most = 0, least = first;
    for (int i = 0; i < 160000; ++i) {
      stepper.step(state, {}, part * limit);
      most = std::max(most, energy(model, state));
      least = std::min(least, energy(model, state));
    }
    // The scheme keeps E - dt k x v / 2, that is E (1 - part sin(2 phase)): so E stays within (1 + part) / (1 - part).
    EXPECT_LT(most, first * (1 + 1e-6) * (1 + part) / (1 - part)) << part;
    EXPECT_GT(least, first * (1 - 1e-6) * (1 - part) / (1 + part)) << part;
  }
}

TEST(SymplecticEuler, BeyondTheStableStepItSaysSo) {
  Chain model({mass}, {.anchor = spring});
  SymplecticEuler stepper(model);
  State state = model.state();
  state.x[0] += Vec3(0.1, 0, 0);
  int n_finite = 0;
  const auto run = [&] {
    for (; n_finite < 100000; ++n_finite) {
      stepper.step(state, {}, 1.01 * limit);
      ASSERT_TRUE(state.x[0].allFinite() && state.v[0].allFinite()) << n_finite;
    }
  };
  EXPECT_THROW(run(), NumericalError);
  EXPECT_GT(n_finite, 10);
}

} // namespace
} // namespace kerf::dynamics::symplectic_euler_test
