#include "dynamics/adaptive.h"

#include "base/error.h"
#include "dynamics/body_force.h"
#include "tests/dynamics/chain.h"
#include "tests/dynamics/integrators.h"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::dynamics::adaptive_test {
namespace {

const double stiffness = 40;

AdaptiveStepper adaptive(ElasticModel& model, const Integrator& integrator, const double tolerance) {
  return AdaptiveStepper(model, integrator.make(model), integrator.order, {.tolerance = tolerance});
}

struct Outcome {
  double error = 0; // largest at the end of a step [m]
  int n_substeps = 0, n_rejected = 0;
};

/// An oscillator for 1 s in steps of 0.1 s, far too long for it.
Outcome oscillate(const Integrator& integrator, const double tolerance) {
  Chain model({1}, {.anchor = stiffness});
  State state = model.state();
  state.x[0] += Vec3(0.1, 0, 0);
  AdaptiveStepper stepper = adaptive(model, integrator, tolerance);
  Outcome outcome;
  for (int i = 1; i <= 10; ++i) {
    const StepReport report = stepper.step(state, {}, 0.1);
    EXPECT_NEAR(state.time, 0.1 * i, 1e-12);
    outcome.n_substeps += report.n_substeps;
    outcome.n_rejected += report.n_rejected;
    outcome.error =
      std::max(outcome.error, std::abs(state.x[0][0] - 0.1 * std::cos(std::sqrt(stiffness) * state.time)));
  }
  return outcome;
}

class Adaptive : public testing::TestWithParam<Integrator> {};

/// The error is below tolerance times time, and not absurdly below: substeps go as tolerance^(-1/p), or somewhat
/// faster.
TEST_P(Adaptive, KeepsItsTolerance) {
  int before = 0;
  for (const double tolerance : {1e-2, 1e-3, 1e-4}) {
    const Outcome outcome = oscillate(GetParam(), tolerance);
    EXPECT_LT(outcome.error, tolerance);
    EXPECT_GT(outcome.error, tolerance / 100);
    if (before > 0) {
      const double rate = std::log10(outcome.n_substeps / double(before));
      EXPECT_GT(rate, 1.0 / GetParam().order - 0.2);
      EXPECT_LT(rate, 1.05);
    }
    before = outcome.n_substeps;
    RecordProperty("error_over_tolerance_" + std::to_string(tolerance), std::to_string(outcome.error / tolerance));
  }
}

INSTANTIATE_TEST_SUITE_P(Implicit, Adaptive,
                         testing::Values(integrators()[4], integrators()[5], integrators()[8], integrators()[10]),
                         [](const auto& info) { return info.param.name; });

TEST(Adaptive, ShortensStepsWhereItMustAndOnlyThere) {
  Chain model({1}, {.anchor = stiffness});
  State state = model.state(); // at rest: nothing to resolve
  AdaptiveStepper stepper = adaptive(model, integrators()[5], 1e-4);
  EXPECT_EQ(stepper.step(state, {}, 0.1).n_substeps, 1);
  state.x[0] += Vec3(0.1, 0, 0);
  const StepReport report = stepper.step(state, {}, 0.1);
  EXPECT_GT(report.n_substeps, 3);
  EXPECT_GE(report.n_rejected, 1);
}

/// A force that sets in at once, in the middle of a step: a free mass then has v = a (t - t_0).
TEST(Adaptive, PassesAJumpOfAForce) {
  for (const int which : {5, 8, 10}) { // implicit Euler does not see where in a step a force sets in
    Chain model({1}, {});
    State state = model.state();
    Loads loads;
    loads.acting.push_back(
      std::make_unique<BodyForce>(std::vector<double>{1}, model.rest(),
                                  [](const Vec3&, const double t) { return Vec3(t < 0.1437 ? 0 : 3, 0, 0); }));
    AdaptiveStepper stepper = adaptive(model, integrators()[which], 1e-2);
    for (int i = 0; i < 3; ++i)
      stepper.step(state, loads, 0.1);
    EXPECT_NEAR(state.v[0][0], 3 * (0.3 - 0.1437), 2e-3) << integrators()[which].name;
  }
}

/// A stepper that is made again goes on with the same substeps.
TEST(Adaptive, GoesOnFromACarriedState) {
  Chain model({1}, {.anchor = stiffness});
  State once = model.state();
  once.x[0] += Vec3(0.1, 0, 0);
  State twice = once;
  AdaptiveStepper stepper = adaptive(model, integrators()[10], 1e-3);
  for (int i = 0; i < 4; ++i) {
    stepper.step(once, {}, 0.1);
    adaptive(model, integrators()[10], 1e-3).step(twice, {}, 0.1);
  }
  EXPECT_EQ(once.x, twice.x);
  EXPECT_EQ(once.v, twice.v);
}

TEST(Adaptive, GivesUpWithTheTolerance) {
  Chain model({1}, {.anchor = stiffness});
  State state = model.state();
  state.x[0] += Vec3(0.1, 0, 0);
  const State before = state;
  AdaptiveStepper stepper(model, integrators()[4].make(model), 1, {.tolerance = 1e-6, .shortest = 1e-4});
  EXPECT_THROW(stepper.step(state, {}, 0.1), NumericalError);
  EXPECT_EQ(state.x, before.x);
  EXPECT_EQ(state.time, before.time);
}

} // namespace
} // namespace kerf::dynamics::adaptive_test
