/// Reactions, power and the balances they close.

#include "dynamics/quantities.h"

#include "dynamics/body_force.h"
#include "dynamics/forces.h"
#include "dynamics/handle.h"
#include "tests/dynamics/chain.h"
#include "tests/dynamics/integrators.h"

#include <Eigen/Geometry>

#include <gtest/gtest.h>

namespace kerf::dynamics::quantities_test {
namespace {

Vec3 still(double) { return Vec3::Zero(); }

/// Two supports carry three masses at rest: together the weight, each its share, torques by the lever.
TEST(Reactions, CarryTheWeight) {
  Chain model({1, 2, 4}, {.neighbour = 500});
  Loads loads{.gravity = Vec3(0, 0, -10), .supports = {}};
  loads.supports = {{{0}, {model.rest()[0]}, still}, {{2}, {model.rest()[2]}, still}};
  State state = model.state();
  state.x[1][2] = -2.0 * 10 / 1000; // on two springs
  const Points none(3, Vec3::Zero());
  const Vec3 about(0.05, 0.3, 0);
  const auto found = reactions(model, loads, state, none, about);
  EXPECT_LT((found[0].force - Vec3(0, 0, 10 + 10)).norm(), 1e-12);
  EXPECT_LT((found[1].force - Vec3(0, 0, 40 + 10)).norm(), 1e-12);
  EXPECT_LT((found[0].torque - (model.rest()[0] - about).cross(found[0].force)).norm(), 1e-12);
  EXPECT_LT((found[0].force + found[1].force + external_force(model, loads, state)).norm(), 1e-12);
}

/// What two supports hold together of one corner is shared, and sums to the whole.
TEST(Reactions, OfSharedCornersSumToTheWhole) {
  Chain model({3}, {});
  Loads loads{.gravity = Vec3(1, -2, -10), .supports = {}};
  loads.supports = {{{0}, {model.rest()[0]}, still, {}, held_axes("xz")},
                    {{0}, {model.rest()[0]}, still, {}, held_along(Vec3(0, 1, 1))}};
  const auto found = reactions(model, loads, model.state(), Points(1, Vec3::Zero()), Vec3::Zero());
  EXPECT_LT((found[0].force + found[1].force + 3 * loads.gravity).norm(), 1e-12);
  EXPECT_NEAR(found[0].force[1], 0, 1e-12);
  EXPECT_LT(found[1].force.cross(Vec3(0, 1, 1)).norm(), 1e-12);
}

/// Momentum changes by what acts: external forces and reactions, over every step of a supported, damped, driven chain.
TEST(Reactions, CloseTheBalanceOfMomentum) {
  Chain model({1, 2, 0.5, 1}, {.anchor = 0, .neighbour = 300});
  Loads loads{.gravity = Vec3(0, 0, -9.81), .mass_damping = 0.5, .stiffness_damping = 0.01, .supports = {}};
  loads.supports = {{{0}, {model.rest()[0]}, [](const double t) { return Vec3(0.1 * std::sin(5 * t), 0, 0); }},
                    {{3}, {model.rest()[3]}, still, {}, held_along(Vec3(1, 1, 0))}};
  loads.acting.push_back(std::make_unique<BodyForce>(std::vector<double>(4, 0.3), model.rest(),
                                                     [](const Vec3&, const double t) { return Vec3(t, 2, -t); }));
  State state = model.state();
  state.v[1] = Vec3(0.2, -0.3, 0.1);
  ImplicitEuler stepper(model, {.cg_tolerance = 1e-14});
  for (int i = 0; i < 50; ++i) {
    const State before = state;
    stepper.step(state, loads, 0.01);
    Vec3 force = external_force(model, loads, state);
    for (const Reaction& reaction : reactions(model, loads, state, mean_acceleration(before, state), Vec3::Zero()))
      force += reaction.force;
    EXPECT_LT(((momentum(model, state) - momentum(model, before)) / 0.01 - force).norm(), 1e-8) << i;
  }
}

TEST(Momentum, AngularIsAboutAPoint) {
  Chain model({2, 3}, {});
  State state = model.state();
  state.v = {Vec3(0, 1, 0), Vec3(0, 0, 2)};
  const Vec3 about(0, 0, 1);
  EXPECT_LT((angular_momentum(model, state, about) - 2 * Vec3(0, 0, -1).cross(Vec3(0, 1, 0)) -
             3 * Vec3(0.1, 0, -1).cross(Vec3(0, 0, 2)))
              .norm(),
            1e-14);
}

/// Energy that is there, came in and went out, along a motion with all of it; second order like the integrator.
TEST(Energy, IsAccountedFor) {
  const auto error = [](const int n) {
    Chain model({1, 2, 0.5}, {.anchor = 5, .cubic = 50, .neighbour = 100});
    Loads loads{.gravity = Vec3(0, 0, -3), .mass_damping = 0.4, .stiffness_damping = 0.002, .supports = {}};
    loads.supports = {{{0}, {model.rest()[0]}, [](const double t) { return Vec3(0, 0.05 * std::sin(4 * t), 0); }}};
    const auto target = [](const double t) { return Vec3(0.2, 0.3 * t, 0); };
    Interpolation tip;
    const std::uint32_t corner = 2;
    const double one = 1;
    tip.add_row({&corner, 1}, {&one, 1});
    loads.acting.push_back(std::make_unique<HandleDamper>(tip, 0.8, target));
    State state = model.state();
    state.v[0][1] = 0.2;
    const auto energy = [&] {
      return kinetic_energy(model, state.v) + model.energy(state.x) + gravity_energy(model, loads, state.x);
    };
    const double before = energy(), dt = 1.0 / n;
    VelocityVerlet stepper(model, go_on);
    for (int i = 0; i < n; ++i) {
      const auto power_now = [&] { // the support's own motion is known: y'' = -0.8 sin(4 t)
        Points a(3, Vec3::Zero());
        a[0][1] = -0.8 * std::sin(4 * state.time);
        Power all = power(model, loads, state, a);
        all.dissipated += damping_power(model, loads, state);
        all.loads = driving_power(loads, state);
        return all;
      };
      const Power begin = power_now();
      stepper.step(state, loads, dt);
      book(begin, power_now(), dt, state);
    }
    EXPECT_GT(state.numbers.at("dissipated energy [J]"), 1e-3);
    EXPECT_GT(std::abs(state.numbers.at("work of supports [J]")), 1e-3);
    EXPECT_GT(std::abs(state.numbers.at("work of loads [J]")), 1e-3);
    return std::abs(energy() - before + state.numbers.at("dissipated energy [J]") -
                    state.numbers.at("work of supports [J]") - state.numbers.at("work of loads [J]"));
  };
  const double first = error(400), last = error(3200);
  EXPECT_LT(last, 1e-5);
  EXPECT_NEAR(std::log2(first / last) / 3, 2, 0.3);
}

} // namespace
} // namespace kerf::dynamics::quantities_test
