/// Bodies in motion: momenta, energy, rotation, dust.

#include "dynamics/implicit_euler.h"
#include "dynamics/symplectic_euler.h"
#include "tests/pba/clouds.h"

#include <gtest/gtest.h>

#include <numeric>

namespace kerf::pba::motion_test {
namespace {

using dynamics::State;

const material::Elastic rubber{.density = 1000, .youngs_modulus = 2e4, .poissons_ratio = 0.4};

PhyxelModel make_model(const Points& rest) { return {make_phyxels(rest, 0.06, 30), rubber, {}}; }

struct Totals {
  Vec3 momentum = Vec3::Zero(), angular = Vec3::Zero();
  double kinetic = 0;
};

Totals totals(const PhyxelModel& model, const State& state) {
  Totals sum;
  for (std::size_t i = 0; i < state.x.size(); ++i) {
    const Vec3 p = model.lumped_mass()[i] * state.v[i];
    sum.momentum += p;
    sum.angular += state.x[i].cross(p);
    sum.kinetic += 0.5 * p.dot(state.v[i]);
  }
  return sum;
}

TEST(Motion, FreeFlightKeepsMomentumAndAngularMomentum) {
  Draw draw(1);
  const Points rest = grid_points({5, 4, 3}, 0.1, 0.5, draw);
  PhyxelModel model = make_model(rest);
  const double dt = 0.5 / largest_frequency(model);
  dynamics::SymplecticEuler stepper(model);
  State state{disturbed(rest, 0.01, draw), {}, 0};
  for (const Vec3& p : rest)
    state.v.push_back(Vec3(1, 0.5, -0.3) + Vec3(0.5, 2, 1).cross(p) + 0.2 * draw.vector());
  const Totals before = totals(model, state);
  const double energy = before.kinetic + model.energy(state.x);
  for (int n = 0; n < 5000; ++n)
    stepper.step(state, {}, dt);
  const Totals after = totals(model, state);
  EXPECT_LT((after.momentum - before.momentum).norm(), 1e-12 * before.momentum.norm());
  EXPECT_LT((after.angular - before.angular).norm(), 1e-10 * before.angular.norm());
  EXPECT_NEAR(after.kinetic + model.energy(state.x), energy, 0.03 * energy);
  record("momentum", (after.momentum - before.momentum).norm() / before.momentum.norm());
  record("angular momentum", (after.angular - before.angular).norm() / before.angular.norm());
}

TEST(Motion, ImplicitEulerComesToRestAtLargeSteps) {
  Draw draw(2);
  const Points rest = grid_points({5, 4, 3}, 0.1, 0.5, draw);
  PhyxelModel model = make_model(rest);
  dynamics::ImplicitEulerOptions options;
  options.n_newton = 3;
  dynamics::ImplicitEuler stepper(model, options);
  State state{disturbed(mapped(rest, draw.rotation(), draw.vector()), 0.02, draw), {}, 0};
  state.v.assign(rest.size(), Vec3::Zero());
  const double before = model.energy(state.x);
  dynamics::Loads loads;
  loads.mass_damping = 2;
  for (int n = 0; n < 300; ++n)
    stepper.step(state, loads, 1.0 / 60);
  EXPECT_LT(model.energy(state.x), 1e-8 * before);
}

/// Linear elasticity oscillates with the frequency of its stiffness: the step of both integrators meets one law.
TEST(Motion, ImplicitAndExplicitStepsAgree) {
  Draw draw(3);
  const Points rest = grid_points({4, 3, 3}, 0.1, 0.5, draw);
  PhyxelModel model = make_model(rest);
  const double dt = 0.01 / largest_frequency(model);
  dynamics::ImplicitEulerOptions options;
  options.n_newton = 2;
  options.cg_tolerance = 1e-12;
  dynamics::ImplicitEuler implicit(model, options);
  dynamics::SymplecticEuler symplectic(model);
  State a{disturbed(rest, 0.005, draw), Points(rest.size(), Vec3::Zero()), 0}, b = a;
  const Points start = a.x;
  for (int n = 0; n < 50; ++n) {
    implicit.step(a, {}, dt);
    symplectic.step(b, {}, dt);
  }
  double moved = 0, apart = 0;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    moved = std::max(moved, (b.x[i] - start[i]).norm());
    apart = std::max(apart, (a.x[i] - b.x[i]).norm());
  }
  EXPECT_LT(apart, 0.03 * moved);
}

/// Removes every pair in random order, ten thousand or more, in a body that flies, turns and shakes. The energy that a
/// removal leaves in place is counted apart from what the integrator makes of it.
TEST(Motion, GroundToDust) {
  Draw draw(4);
  const Points rest = grid_points({10, 10, 8}, 0.05, 0.5, draw);
  PhyxelModel model = make_model(rest);
  auto sights = clear_sights(rest, rest, model.neighbours().pairs);
  ASSERT_GE(sights.size(), 10000u);
  std::vector<std::size_t> order(sights.size());
  std::iota(order.begin(), order.end(), 0);
  for (std::size_t i = order.size() - 1; i > 0; --i)
    std::swap(order[i], order[draw.below(i + 1)]);

  dynamics::SymplecticEuler stepper(model);
  State state{disturbed(rest, 0.003, draw), {}, 0};
  for (const Vec3& p : rest)
    state.v.push_back(Vec3(1, 0, 0.5) + Vec3(0, 1, 2).cross(p) + 0.05 * draw.vector());
  const Totals before = totals(model, state);
  const double start = before.kinetic + model.energy(state.x);
  double most = start, by_removals = 0, fastest = 0;
  const std::size_t each = 20;
  for (std::size_t first = 0; first < order.size(); first += each) {
    const double held = model.energy(state.x);
    for (std::size_t k = first; k < std::min(first + each, order.size()); ++k)
      sights[order[k]].factor = 0;
    model.update(sights);
    by_removals += std::max(0.0, model.energy(state.x) - held);
    model.linearise(state.x);
    const double frequency = largest_frequency(model, 12);
    fastest = std::max(fastest, frequency);
    stepper.step(state, {}, frequency > 0 ? 0.1 / frequency : 1e-3);
    most = std::max(most, totals(model, state).kinetic + model.energy(state.x));
  }
  const Totals after = totals(model, state);
  record("most energy over the start's", most / start);
  record("put in by removals", by_removals / start);
  record("largest frequency", fastest);
  EXPECT_LT((after.momentum - before.momentum).norm(), 1e-12 * before.momentum.norm());
  EXPECT_LT((after.angular - before.angular).norm(), 1e-10 * before.angular.norm());
  EXPECT_EQ(model.energy(state.x), 0);
  EXPECT_LT(most, 1.01 * start);
  for (const Vec3& v : state.v)
    EXPECT_TRUE(v.allFinite());
}

} // namespace
} // namespace kerf::pba::motion_test
