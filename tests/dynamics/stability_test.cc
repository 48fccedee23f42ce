/// Energy over long times, what is left of unresolved vibrations, and the stable step of explicit integrators.

#include "base/error.h"
#include "dynamics/forces.h"
#include "dynamics/handle.h"
#include "tests/dynamics/chain.h"
#include "tests/dynamics/integrators.h"

#include <Eigen/Eigenvalues>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace kerf::dynamics::stability_test {
namespace {

double energy(const ForceModel& model, const State& state) {
  return model.energy(state.x) + kinetic_energy(model, state.v);
}

/// The highest frequency of n free masses m in a row on springs k.
double highest_frequency(const int n, const double m, const double k) {
  return 2 * std::sqrt(k / m) * std::cos(std::numbers::pi / (2 * n));
}

/// A nonlinear chain near its stable step: no drift, whatever it does in between.
TEST(Symplectic, EnergyDoesNotDriftOver100000Steps) {
  for (const int which : {1, 3}) {
    Chain model({1, 2, 0.5, 1}, {.anchor = 20, .cubic = 100, .neighbour = 200});
    State state = model.state();
    state.v = {Vec3(0.1, 0.2, 0), Vec3(0, -0.3, 0.1), Vec3(0.2, 0, 0.2), Vec3(0, 0, -0.1)};
    const auto stepper = integrators()[which].make(model);
    constexpr int n = 100000, window = 5000;
    double first = 0, last = 0, most = 0, least = 1e300;
    for (int i = 0; i < n; ++i) {
      stepper->step(state, {}, 0.02);
      const double now = energy(model, state);
      first += i < window ? now / window : 0;
      last += i >= n - window ? now / window : 0;
      most = std::max(most, now);
      least = std::min(least, now);
    }
    EXPECT_NEAR(last / first, 1, which == 1 ? 0.02 : 2e-3) << integrators()[which].name;
    EXPECT_LT(most / least, 2.5) << integrators()[which].name;
    RecordProperty("drift_" + integrators()[which].name, std::to_string(last / first - 1));
  }
}

TEST(Newmark, AverageAccelerationKeepsTheEnergyOfALinearBody) {
  for (const double dt : {0.01, 0.3, 10.0}) {
    Chain model({1, 2, 0.5, 1}, {.anchor = 20, .neighbour = 200});
    State state = model.state();
    state.x[1] += Vec3(0.1, 0.2, -0.1);
    const double before = energy(model, state);
    const auto stepper = integrators()[5].make(model);
    for (int i = 0; i < 2000; ++i)
      stepper->step(state, {}, dt);
    EXPECT_NEAR(energy(model, state) / before, 1, 1e-10) << dt;
  }
}

/// What a step makes of (x, v, a) of one vibration, by steps from unit states.
Eigen::Matrix3d amplification(const AlphaCoefficients& coefficients, const double dt) {
  Eigen::Matrix3d A;
  for (int k = 0; k < 3; ++k) {
    Chain model({1}, {.anchor = 1});
    State state = model.state();
    state.history["acceleration"] = {Vec3::Zero()};
    Vec3& unit = k == 0 ? state.x[0] : k == 1 ? state.v[0] : state.history["acceleration"][0];
    unit += Vec3(k == 1 ? 1 / dt : k == 2 ? 1 / (dt * dt) : 1, 0, 0); // all of them lengths
    made_alpha(model, coefficients)->step(state, {}, dt);
    A.col(k) << state.x[0][0], dt * state.v[0][0], dt * dt * state.history["acceleration"][0][0];
  }
  return A;
}

/// One mass at rest in its well, under way, and then let go at a distance of 1 m from its balance by a cut.
State let_go(Stepper& stepper, const Chain& model, const double dt) {
  State state = model.state();
  stepper.step(state, {}, dt);
  state.x[0] += Vec3(1, 0, 0);
  forget_forces(state);
  return state;
}

/// What no step resolves comes to its balance and is as slow as steps let it be. With the acceleration of the balance
/// of forces it swung by 1 m and ran at its own 1,000 m/s.
TEST(Newmark, WhatACutLetsGoDoesNotRing) {
  constexpr double frequency = 1e3, dt = 0.02;
  for (const double rho : {-1.0, 0.8, 1.0}) { // -1: Newmark's
    Chain model({1}, {.anchor = frequency * frequency});
    GeneralisedAlpha stepper(model, rho < 0 ? newmark(0.25, 0.5) : generalised_alpha(rho), {.cg_tolerance = 1e-14});
    State state = let_go(stepper, model, dt);
    for (int i = 0; i < 200; ++i) {
      stepper.step(state, {}, dt);
      EXPECT_LT((state.x[0] - model.rest()[0]).norm(), 0.2) << rho << ", " << i;
      EXPECT_LT(state.v[0].norm(), 2.1 / dt) << rho << ", " << i;
    }
  }
}

/// What steps resolve moves with an error of second order, and keeps its energy even if something is cut in each of
/// them.
TEST(Newmark, WhatACutLetsGoSwingsAsItShould) {
  constexpr double frequency = 3, end = 2;
  Chain model({1}, {.anchor = frequency * frequency});
  GeneralisedAlpha stepper(model, newmark(0.25, 0.5), {.cg_tolerance = 1e-14});
  std::vector<double> errors, lost;
  for (const int n : {50, 100, 200}) {
    const double dt = end / n;
    State once = let_go(stepper, model, dt), ever = once;
    const double before = energy(model, ever);
    for (int i = 0; i < n; ++i) {
      stepper.step(once, {}, dt);
      forget_forces(ever);
      stepper.step(ever, {}, dt);
    }
    errors.push_back(std::abs((once.x[0] - model.rest()[0])[0] - std::cos(frequency * end)));
    lost.push_back(1 - energy(model, ever) / before);
  }
  for (int k = 0; k < 2; ++k)
    EXPECT_NEAR(std::log2(errors[k] / errors[k + 1]), 2, 0.1);
  EXPECT_LT(std::abs(lost[0]), 0.01); // implicit Euler: 0.5
  EXPECT_LT(std::abs(lost[2]), 0.001);
}

TEST(GeneralisedAlpha, LeavesItsSpectralRadiusAtHighFrequency) {
  for (const double rho_inf : {0.0, 0.3, 0.5, 0.8, 1.0}) {
    const double rho = amplification(generalised_alpha(rho_inf), 1e5).eigenvalues().cwiseAbs().maxCoeff();
    EXPECT_NEAR(rho, rho_inf, 2e-3) << rho_inf; // a double root, so the root of round-off
  }
}

TEST(GeneralisedAlpha, IsStableForEveryStep) {
  for (const double rho_inf : {0.0, 0.3, 0.8, 1.0})
    for (double dt = 1e-3; dt < 1e5; dt *= 1.7)
      EXPECT_LE(amplification(generalised_alpha(rho_inf), dt).eigenvalues().cwiseAbs().maxCoeff(), 1 + 3e-6)
        << rho_inf << " " << dt; // a double root again
}

TEST(GeneralisedAlpha, RefusesCoefficientsThatGainEnergy) {
  EXPECT_THROW(generalised_alpha(-0.1), ParameterError);
  EXPECT_THROW(generalised_alpha(1.1), ParameterError);
  EXPECT_THROW(generalised_alpha(std::nan("")), ParameterError);
  EXPECT_THROW(newmark(0, 0.5), ParameterError);
  EXPECT_THROW(newmark(0.25, 0.49), ParameterError);
}

/// For w dt -> infinity the recurrence 9/4 x_1 = (w dt)^-2 ... leaves 1 / (w dt)^2 a step.
TEST(Bdf2, WhatIsNotResolvedDiesAtOnce) {
  Chain model({1}, {.anchor = 1});
  State state = model.state();
  state.x[0] += Vec3(1, 0, 0);
  const auto stepper = integrators().back().make(model);
  for (int i = 0; i < 3; ++i)
    stepper->step(state, {}, 1e4);
  EXPECT_LT(std::abs(state.x[0][0]), 1e-7);
  EXPECT_LT(std::abs(state.v[0][0]), 1e-11);
}

TEST(Bdf2, StepsMayChange) {
  const auto error = [](const int n) { // steps dt, dt/2, dt, 2 dt, ... of the same mean
    Chain model({1}, {.anchor = 25});
    State state = model.state();
    state.x[0] += Vec3(0.1, 0, 0);
    const auto stepper = integrators().back().make(model);
    const double parts[] = {0.8, 0.5, 0.9, 1.8};
    for (int i = 0; i < n; ++i)
      stepper->step(state, {}, parts[i % 4] / n);
    return std::abs(state.x[0][0] - 0.1 * std::cos(5 * state.time));
  };
  EXPECT_NEAR(std::log2(error(1600) / error(6400)) / 2, 2, 0.1);
}

/// The scheme's own 2 x 2 matrix against a step of the integrator.
TEST(StableStep, KnowsWhatAStepDoes) {
  const double k = 30, alpha = 0.7, beta = 0.03, dt = 0.05, c = 0.4;
  const ExplicitScheme schemes[] = {ExplicitEuler::scheme(), SymplecticEuler::scheme(), MidpointRungeKutta::scheme(),
                                    VelocityVerlet::scheme()};
  for (int s = 0; s < 4; ++s)
    for (const int column : {0, 1}) {
      Chain model({1}, {.anchor = k});
      State state = model.state();
      (column == 0 ? state.x : state.v)[0] += Vec3(1, 0, 0);
      Loads loads{.mass_damping = alpha, .stiffness_damping = beta, .supports = {}};
      loads.acting.push_back(
        std::make_unique<HandleDamper>(corners_themselves(1), c, [](double) { return Vec3(Vec3::Zero()); }));
      integrators()[s].make(model)->step(state, loads, dt);
      const Eigen::Matrix2d A = schemes[s].amplification({k, alpha, beta * k + c}, dt);
      EXPECT_NEAR(state.x[0][0], A(0, column), 1e-13) << schemes[s].name;
      EXPECT_NEAR(state.v[0][0], A(1, column), 1e-12) << schemes[s].name;
    }
}

TEST(StableStep, IsTwoOverTheHighestFrequencyOfAChain) {
  for (const int n : {2, 7, 60, 400}) {
    Chain model(std::vector<double>(n, 0.2), {.neighbour = 75});
    const double exact = 2 / highest_frequency(n, 0.2, 75);
    for (const ExplicitScheme& scheme : {SymplecticEuler::scheme(), VelocityVerlet::scheme()})
      EXPECT_NEAR(StepLimit(model, scheme, {}).at(model.state(), {}) / exact, 1, 2e-3) << scheme.name << " " << n;
  }
}

/// Undamped vibrations grow by y^2 / 2 and y^4 / 8 a step, y = w dt.
TEST(StableStep, OfSchemesThatLetVibrationsGrowKeepsTheirAllowance) {
  Chain model({0.2}, {.anchor = 75});
  const double w = std::sqrt(75 / 0.2), allowed = 1e-3;
  EXPECT_NEAR(StepLimit(model, ExplicitEuler::scheme(), {}).at(model.state(), {}), std::sqrt(2 * allowed) / w,
              1e-3 / w);
  EXPECT_NEAR(StepLimit(model, MidpointRungeKutta::scheme(), {}).at(model.state(), {}), std::pow(8 * allowed, 0.25) / w,
              2e-3 / w);
}

/// dt^2 w^2 + 2 (beta w^2 - alpha) dt = 4 for symplectic Euler, whose mass damping is implicit.
TEST(StableStep, KnowsDamping) {
  const double m = 0.2, k = 75, w2 = k / m;
  for (const double alpha : {0.0, 3.0, 50.0})
    for (const double beta : {0.0, 0.01, 0.1}) {
      Chain model({m}, {.anchor = k});
      const double b = beta * w2 - alpha, exact = (-b + std::sqrt(b * b + 4 * w2)) / w2;
      const Loads loads{.mass_damping = alpha, .stiffness_damping = beta, .supports = {}};
      EXPECT_NEAR(StepLimit(model, SymplecticEuler::scheme(), {}).at(model.state(), loads) / exact, 1, 1e-6)
        << alpha << " " << beta;
    }
}

/// Stiff handles lead a mass along a curved way with what it takes to move it, 1.8 N (26 N where the handle is ahead of
/// where a balance between two times has the mass).
TEST(Integrators, StiffLoadsLeadByWhatItTakes) {
  constexpr double mass = 3, stiffness = 1.5e7, acceleration = 0.6, dt = 0.005;
  for (std::size_t which = 4; which < integrators().size(); ++which) { // the implicit ones
    const Integrator& integrator = integrators()[which];
    Chain model({mass}, {});
    Interpolation point;
    const std::uint32_t corner = 0;
    const double one = 1;
    point.add_row({&corner, 1}, {&one, 1});
    const auto target = [&](const double t) { return Vec3(0.3 * t, 0, 0.5 * acceleration * t * t); };
    Loads loads;
    loads.acting.push_back(std::make_unique<HandleSpring>(point, stiffness, target));
    State state = model.state();
    state.v[0] = Vec3(0.3, 0, 0);
    const auto stepper = integrator.make(model);
    double sum = 0;
    constexpr int n_steps = 400, n_last = 100;
    for (int i = 0; i < n_steps; ++i) {
      stepper->step(state, loads, dt);
      if (i >= n_steps - n_last)
        sum += stiffness * (target(state.time) - state.x[0]).z() / n_last;
    }
    EXPECT_NEAR(sum, mass * acceleration, 0.05 * mass * acceleration) << integrator.name;
  }
}

TEST(StableStep, KnowsSupportsAndLoads) {
  Chain model({0.2, 0.2}, {.neighbour = 75});
  Loads loads;
  const auto still = [](double) { return Vec3(Vec3::Zero()); };
  loads.supports = {{{0}, {model.rest()[0]}, still}};
  EXPECT_NEAR(StepLimit(model, VelocityVerlet::scheme(), {}).at(model.state(), loads), 2 / std::sqrt(75 / 0.2), 1e-5);
  Interpolation tip;
  const std::uint32_t corner = 1;
  const double one = 1;
  tip.add_row({&corner, 1}, {&one, 1});
  loads.acting.push_back(std::make_unique<HandleSpring>(tip, 225, [&](double) { return model.rest()[1]; }));
  EXPECT_NEAR(StepLimit(model, VelocityVerlet::scheme(), {}).at(model.state(), loads), 1 / std::sqrt(75 / 0.2), 1e-5);
}

/// Just below the stable step energy is bounded; just above it explodes, and is refused with the number before it does.
TEST(StableStep, IsTheLimit) {
  constexpr int n = 30;
  const double exact = 2 / highest_frequency(n, 0.2, 75);
  for (const int which : {1, 3}) {
    Chain model(std::vector<double>(n, 0.2), {.neighbour = 75});
    const auto growth = [&](const double dt, const int n_steps) {
      State state = model.state();
      for (int i = 0; i < n; ++i)
        state.v[i] = Vec3(i % 2 ? 1 : -1, 0, 0);
      const double before = energy(model, state);
      const auto stepper = integrators()[which].make(model);
      for (int i = 0; i < n_steps; ++i)
        stepper->step(state, {}, dt);
      return energy(model, state) / before;
    };
    EXPECT_LT(growth(0.99 * exact, 3000),
              300); // at 0.99 a scheme keeps an energy that may be 1 / (1 - 0.99^2) times off
    EXPECT_GT(growth(1.01 * exact, 400), 1e30);
  }
}

TEST(StableStep, IsRefusedWithTheNumber) {
  Chain model(std::vector<double>(30, 0.2), {.neighbour = 75});
  const double exact = 2 / highest_frequency(30, 0.2, 75);
  VelocityVerlet stepper(model, {});
  State state = model.state();
  stepper.step(state, {}, 0.99 * exact);
  EXPECT_THROW(stepper.step(state, {}, 1.01 * exact), NumericalError) << "it was shorter: may be divided";
  EXPECT_NEAR(state.time, 0.99 * exact, 1e-15); // as it was
  state = model.state();
  try {
    VelocityVerlet(model, {}).step(state, {}, 1.01 * exact);
    FAIL() << "took a step beyond its stable one";
  } catch (const ParameterError& error) {
    const std::string& rule = error.complaint().rule;
    EXPECT_TRUE(rule.starts_with("velocity Verlet is stable here up to ")) << rule;
    EXPECT_NEAR(std::stod(rule.substr(rule.find("up to ") + 6)), exact, 1e-2 * exact) << rule;
    EXPECT_NE(error.complaint().remedy.find("go on"), std::string::npos);
  }
  EXPECT_EQ(state.time, 0); // as it was
  EXPECT_NO_THROW(VelocityVerlet(model, go_on).step(state, {}, 1.01 * exact));
  for (const double dt : {0.99, 1.01})
    if (state = model.state(); dt > 1)
      EXPECT_THROW(SymplecticEuler(model, {}).step(state, {}, dt * exact), ParameterError);
    else
      EXPECT_NO_THROW(SymplecticEuler(model, {}).step(state, {}, dt * exact));
  EXPECT_THROW(ExplicitEuler(model, {}).step(state, {}, 0.1 * exact), ParameterError);
  EXPECT_THROW(MidpointRungeKutta(model, {}).step(state, {}, 0.5 * exact), ParameterError);
}

/// Each cut makes integrators again. What it does to the stable step is told at once where that was not asked for
/// within 200 steps, else then; close to the stable one, of a longer step, or of a body without a past at once.
TEST(StableStep, IsAskedForAgainAfterACut) {
  Chain whole(std::vector<double>(30, 0.2), {.neighbour = 75}), cut(std::vector<double>(30, 0.2), {.neighbour = 200});
  const double exact = 2 / highest_frequency(30, 0.2, 75);
  const auto limit = [](Chain& model) {
    return StepLimit(model, VelocityVerlet::scheme(), {});
  };
  for (const double part : {0.7, 0.8})
    for (const int n_before : {0, 50, 199, 200, 1000}) {
      State state = whole.state();
      StepLimit of_whole = limit(whole);
      of_whole.require(state, {}, part * exact, state.numbers);
      EXPECT_NEAR(of_whole.last(), exact, 1e-2 * exact);
      for (int i = 0; i < n_before; ++i)
        of_whole.require(state, {}, part * exact, state.numbers);
      int n = 0;
      try {
        for (; n < 1000; ++n) {
          StepLimit of_cut = limit(cut);
          of_cut.require(state, {}, part * exact, state.numbers);
          EXPECT_EQ(of_cut.last(), of_whole.last());
        }
      } catch (const NumericalError&) {
      }
      EXPECT_EQ(n, part < 0.75 ? std::max(0, 199 - n_before) : 0) << n_before;
    }
  State state = whole.state(), without_past = whole.state();
  limit(whole).require(state, {}, 0.5 * exact, state.numbers);
  EXPECT_NO_THROW(limit(cut).require(state, {}, 0.7 * exact, state.numbers));
  EXPECT_THROW(limit(cut).require(state, {}, 0.8 * exact, state.numbers), NumericalError);
  EXPECT_THROW(limit(cut).require(without_past, {}, 0.7 * exact, without_past.numbers), ParameterError);
}

} // namespace
} // namespace kerf::dynamics::stability_test
