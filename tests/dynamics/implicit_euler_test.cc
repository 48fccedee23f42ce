#include "dynamics/implicit_euler.h"

#include "base/error.h"
#include "tests/dynamics/chain.h"
#include "tests/dynamics/truss.h"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::dynamics::implicit_euler_test {
namespace {

/// Damped oscillator: (1/dt^2 + alpha/dt + (1 + beta/dt) w^2) (x - x_n) = v_n/dt - w^2 x_n, the scheme written out.
TEST(ImplicitEuler, IsItsOwnFormula) {
  const double m = 2, k = 50, alpha = 0.3, beta = 0.02, dt = 0.05;
  Chain model({m}, {.anchor = k});
  ImplicitEuler stepper(model, {.cg_tolerance = 1e-15});
  State state = model.state();
  state.x[0] += Vec3(0.1, -0.2, 0.3);
  Vec3 x = state.x[0], v = state.v[0];
  for (int i = 0; i < 50; ++i) {
    stepper.step(state, {.mass_damping = alpha, .stiffness_damping = beta, .supports = {}}, dt);
    const Vec3 change = (v / dt - k / m * x) / (1 / (dt * dt) + alpha / dt + (1 + beta / dt) * k / m);
    x += change;
    v = change / dt;
    EXPECT_LT((state.x[0] - x).norm(), 1e-14);
    EXPECT_LT((state.v[0] - v).norm(), 1e-13);
  }
}

/// Free fall is guessed exactly from the second step on, and rest under a load from the first: nothing is left to
/// solve.
TEST(ImplicitEuler, FallsAndRestsWithoutIterations) {
  for (const double anchor : {0.0, 40.0}) {
    Chain model({1, 2, 3}, {.anchor = anchor, .neighbour = 500});
    ImplicitEuler stepper(model, {});
    State state = model.state();
    Loads loads;
    loads.gravity = Vec3(0, 0, -9.81);
    if (anchor > 0)
      stepper.step(state, loads, 1e8); // to rest
    state.v.assign(3, Vec3::Zero());
    stepper.step(state, loads, 0.01);
    for (int i = 0; i < 20; ++i)
      EXPECT_EQ(stepper.step(state, loads, 0.01).n_iterations, 0) << anchor << ", step " << i;
    forget_forces(state);
    EXPECT_EQ(stepper.step(state, loads, 0.01).n_iterations, 0) << "a cut far away takes no guess";
    forget_past(state);
    EXPECT_EQ(stepper.step(state, loads, 0.01).n_iterations > 0, anchor == 0) << "nothing is known";
  }
}

/// A very long step goes to equilibrium at once.
TEST(ImplicitEuler, LongStepIsTheStaticAnswer) {
  Chain model({1, 2, 3}, {.anchor = 40});
  ImplicitEuler stepper(model, {.cg_tolerance = 1e-14});
  State state = model.state();
  stepper.step(state, {.gravity = Vec3(0, 0, -9.81), .supports = {}}, 1e8);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(state.x[i][2], -9.81 * model.lumped_mass()[i] / 40, 1e-12);
}

TEST(ImplicitEuler, EnergyNeverGrows) {
  Chain model({1, 2, 3}, {.anchor = 40, .neighbour = 500});
  for (const double dt : {1e-3, 1e-1, 10.0}) {
    ImplicitEuler stepper(model, {.cg_tolerance = 1e-13});
    State state = model.state();
    state.x[1] += Vec3(0.1, 0.2, 0.3);
    double before = model.energy(state.x);
    for (int i = 0; i < 100; ++i) {
      stepper.step(state, {}, dt);
      double energy = model.energy(state.x);
      for (std::size_t k = 0; k < 3; ++k)
        energy += 0.5 * model.lumped_mass()[k] * state.v[k].squaredNorm();
      EXPECT_LE(energy, before * (1 + 1e-12) + 1e-30);
      before = energy;
    }
  }
}

/// Residual of the nonlinear equation of one step, with damping and a moving support.
TEST(ImplicitEuler, NewtonSolvesTheNonlinearStep) {
  const double dt = 0.1;
  const auto residual_after = [&](const int n_newton) {
    Chain model({1, 2, 1}, {.anchor = 3, .cubic = 2000, .neighbour = 50, .weights = Vec3(1, 2, 3)});
    ImplicitEuler stepper(model, {.n_newton = n_newton, .cg_tolerance = 1e-12});
    Loads loads{.gravity = Vec3(0, 0, -9.81), .mass_damping = 0.2, .supports = {}};
    loads.supports = {{{0}, {model.rest()[0]}, [](const double t) { return Vec3(t, 0, 0); }}};
    const State before = [&] {
      State state = model.state();
      state.v[1] = Vec3(1, 2, -1);
      return state;
    }();
    State after = before;
    stepper.step(after, loads, dt);
    Points force;
    model.force(after.x, force);
    double residual = 0;
    for (std::size_t i = 1; i < 3; ++i) {
      const Vec3 moved = after.x[i] - before.x[i];
      const double m = model.lumped_mass()[i];
      residual = std::max(
        residual,
        (m * (moved - dt * before.v[i]) / (dt * dt) + 0.2 * m * moved / dt - force[i] - m * loads.gravity).norm());
    }
    return residual;
  };
  EXPECT_GT(residual_after(1), 1);
  EXPECT_LT(residual_after(4), 0.1 * residual_after(2));
  EXPECT_LT(residual_after(12), 1e-10);
}

/// A moving support drags its neighbour by the spring and by the spring's damping: residual of the linear step.
TEST(ImplicitEuler, StiffnessDampingFeelsMovingSupports) {
  const double dt = 0.1, beta = 0.3, k = 50;
  for (const int n_newton : {1, 2}) {
    Chain model({1, 2, 1}, {.neighbour = k});
    ImplicitEuler stepper(model, {.n_newton = n_newton, .cg_tolerance = 1e-14});
    Loads loads{.stiffness_damping = beta, .supports = {}};
    loads.supports = {{{0}, {model.rest()[0]}, [](const double t) { return Vec3(t, 2 * t, 0); }}};
    State state = model.state();
    state.v[2] = Vec3(0, 0, 1);
    const State before = state;
    stepper.step(state, loads, dt);
    Points force;
    model.force(state.x, force);
    const auto moved = [&](const std::size_t i) -> Vec3 { return state.x[i] - before.x[i]; };
    const auto inertia = [&](const std::size_t i) -> Vec3 {
      return model.lumped_mass()[i] * (moved(i) - dt * before.v[i]) / (dt * dt);
    };
    const Vec3 first = moved(1) - moved(0), second = moved(2) - moved(1);
    EXPECT_LT((inertia(1) + beta / dt * k * (first - second) - force[1]).norm(), 1e-11);
    EXPECT_LT((inertia(2) + beta / dt * k * second - force[2]).norm(), 1e-11);
    EXPECT_GT(moved(1).norm(), 1e-3);
  }
}

TEST(ImplicitEuler, SaysThatConjugateGradientsDidNotConverge) {
  Chain model(std::vector<double>(50, 1.0), {.neighbour = 1e6});
  ImplicitEuler stepper(model, {.cg_tolerance = 1e-10, .max_cg_iterations = 3});
  State state = model.state();
  state.x[20] += Vec3(1, 0, 0);
  const State before = state;
  EXPECT_THROW(stepper.step(state, {}, 1), NumericalError);
  EXPECT_EQ(state.x, before.x);
  EXPECT_EQ(state.v, before.v);
  EXPECT_EQ(state.time, before.time);
}

/// A bar under compression turns: the exact tangent knows, the positive one does not.
TEST(ImplicitEuler, FactorisesTheTangentItsParametersName) {
  const auto n_newton = [](const std::string& tangent) {
    Truss truss({Vec3::Zero(), Vec3(1, 0, 0)}, {{0, 1}}, 1000);
    ImplicitEuler stepper(
      truss,
      implicit_euler_options(
        {.n_newton = 100, .newton_tolerance = 1e-12, .line_search = true, .solver = "direct", .tangent = tangent}));
    State state = truss.state();
    state.x[1] = Vec3(0.6, 0, 0);
    state.v[1] = Vec3(0, 5, 0);
    return stepper.step(state, {}, 0.05).n_newton;
  };
  EXPECT_LT(2 * n_newton("exact"), n_newton("positive"));
}

TEST(ImplicitEuler, CountsItsIterations) {
  Chain model(std::vector<double>(50, 1.0), {.neighbour = 1e3});
  State state = model.state();
  EXPECT_EQ(ImplicitEuler(model, {}).step(state, {}, 0.1).n_iterations, 0);
  state.x[20] += Vec3(1, 0, 0);
  EXPECT_GT(ImplicitEuler(model, {}).step(state, {}, 0.1).n_iterations, 3);
}

} // namespace
} // namespace kerf::dynamics::implicit_euler_test
