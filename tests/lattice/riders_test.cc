/// Corners of hardly any mass: they come to their goals without swinging, and take nothing with them.

#include "lattice/riders.h"

#include "dynamics/forces.h"
#include "dynamics/quantities.h"
#include "surface/placement.h"
#include "tests/lattice/bodies.h"
#include "tests/support/bodies.h"

#include <gtest/gtest.h>

namespace kerf::lattice::riders_test {
namespace {

constexpr double k = 3600;

/// 4 x 3 x 3 nodes whose skin lies `depth` beyond the last nodes upwards, and 0.5 elsewhere.
support::Body shallow_block(const double depth) {
  support::Body body = support::make_body(
    {Vec3::Zero(), 1}, support::block_nodes({4, 3, 3}), [&](const grid::Grid& grid, const grid::EdgeId e) {
      const bool is_upper = grid.is_material(grid.ends(e)[0]);
      const int axis = grid.axis(e);
      return grid::EdgeCut{e, is_upper && axis == 2 ? depth : 0.5, Vec3::Unit(axis), grid::skin_label};
    });
  surface::place(body, {});
  return support::with_copies(std::move(body));
}

/// Rough skins and cuts anywhere: corners of every mass.
Body slivers(const unsigned seed) {
  Draw draw(seed);
  Body body = fem::make_block({5, 4, 3}, 0.1, draw, {1e-4, 0.98});
  fem::cut_at_random(body, 0.15, draw, {1e-3, 0.98});
  return body;
}

TEST(Riders, KeepMomentaAndGainNoEnergy) {
  std::size_t n_riders = 0;
  for (const unsigned seed : {1u, 2u, 3u, 4u}) {
    const Body body = slivers(seed);
    const Matching model(body, {.density = 1000, .half_width = 2, .stiffness = k});
    n_riders += model.riders().n_riders();
    Draw draw(seed);
    dynamics::State state{moved(body, draw, 0.2), {}, 0};
    for (std::size_t i = 0; i < state.x.size(); ++i)
      state.v.push_back(draw.vector());
    dynamics::State after = state;
    model.riders().damp(state.x, model.lumped_mass(), 0.2, after.v);
    const auto momentum = [&](const dynamics::State& s) {
      Vec3 sum = Vec3::Zero();
      for (std::size_t i = 0; i < s.v.size(); ++i)
        sum += model.lumped_mass()[i] * s.v[i];
      return sum;
    };
    EXPECT_LT((momentum(after) - momentum(state)).norm(), 1e-12);
    EXPECT_LT(
      (dynamics::angular_momentum(model, after, Vec3::Zero()) - dynamics::angular_momentum(model, state, Vec3::Zero()))
        .norm(),
      1e-12);
    EXPECT_LT(kinetic_energy(model, after.v), kinetic_energy(model, state.v));
  }
  EXPECT_GT(n_riders, 100u);
}

TEST(Riders, DoNotSeeRigidMotions) {
  const Body body = slivers(5);
  const Matching model(body, {.density = 1000, .half_width = 2, .stiffness = k});
  Draw draw(6);
  const Points x = moved(body, draw, 0.2);
  const Vec3 spin = draw.vector(), shift = draw.vector();
  Points v;
  for (const Vec3& p : x)
    v.push_back(shift + spin.cross(p));
  const Points before = v;
  model.riders().damp(x, model.lumped_mass(), 0.2, v);
  for (std::size_t i = 0; i < v.size(); ++i)
    EXPECT_LT((v[i] - before[i]).norm(), 1e-10) << i;
}

/// Those with slack that are near are free up to half a cube from where the carrier's rotation has them, and no more a
/// cube away from there.
TEST(Riders, WithSlackAreFreeWhereTheCarrierHasThem) {
  const support::Body body = shallow_block(1e-3); // of cubes of 1 m
  const Matching model(body, {.density = 1000, .half_width = 2, .stiffness = k});
  const auto mass = model.lumped_mass();
  const Points rest = grid::rest_positions(body);
  const Riders riders(body.complex, mass, 1000, grid::well_filled, rest, 1);
  EXPECT_EQ(riders.n_riders(), 6u * 5u * 5u - 4u * 3u * 3u) << "all but the nodes";
  const Mat3 turn = Draw(8).rotation();
  const auto lost = [&](const Vec3& at, const double away) { // of the velocity of one that alone moves [1]
    const auto i = static_cast<std::size_t>(std::ranges::find(rest, at) - rest.begin());
    if (i == rest.size()) {
      ADD_FAILURE() << "no corner there";
      return 0.0;
    }
    Points x, v(rest.size(), Vec3::Zero());
    for (const Vec3& p : rest)
      x.push_back(turn * p + Vec3(3, 1, 2));
    x[i] += away * Vec3(1, 2, 2) / 3;
    v[i] = Vec3(1, 0, 0);
    riders.damp(x, mass, 0.2, v);
    return 1 - v[i].norm();
  };
  Points free; // of those above the block's nodes, whose carriers may be beneath
  for (int i = 1; i <= 4; ++i)
    for (int j = 1; j <= 3; ++j)
      if (lost(Vec3(i, j, 4), 0) == 0)
        free.emplace_back(i, j, 4);
  ASSERT_FALSE(free.empty());
  for (const Vec3& near : free) {
    EXPECT_EQ(lost(near, 0.49), 0);
    const double wholly = lost(near, 1.01);
    EXPECT_GT(wholly, 0.5);
    EXPECT_NEAR(lost(near, 0.75), wholly / 2, 0.02);
    EXPECT_NEAR(lost(near, 2), wholly, 0.02);
  }
  EXPECT_EQ(lost(Vec3(2, 0, 4), 0), 0) << "above an edge of the block, two cubes from its carrier";
  EXPECT_GT(lost(Vec3(2, 0, 4), 1.01), 0.5);
}

Vec3 moment(const Matching& model, const Points& x) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < x.size(); ++i)
    sum += model.lumped_mass()[i] * x[i];
  return sum;
}

/// They go to their goals, the lightest all the way, and the masses' centre and both momenta are what they were.
TEST(Riders, SettleWithoutMovingTheWhole) {
  for (const unsigned seed : {1u, 2u, 3u}) {
    const Body body = slivers(seed);
    const Matching model(body, {.density = 1000, .half_width = 2, .stiffness = k});
    Draw draw(seed);
    dynamics::State state{moved(body, draw, 0.2), {}, 0};
    for (std::size_t i = 0; i < state.x.size(); ++i)
      state.v.push_back(draw.vector());
    Points goals;
    model.goals(state.x, goals);
    dynamics::State after = state;
    model.riders().settle(goals, model.lumped_mass(), after.x, after.v);
    EXPECT_LT((moment(model, after.x) - moment(model, state.x)).norm(), 1e-12);
    EXPECT_LT((moment(model, after.v) - moment(model, state.v)).norm(), 1e-12);
    EXPECT_LT(
      (dynamics::angular_momentum(model, after, Vec3::Zero()) - dynamics::angular_momentum(model, state, Vec3::Zero()))
        .norm(),
      1e-12);
    EXPECT_LT(model.energy(after.x), model.energy(state.x));
    std::size_t n_there = 0;
    for (std::size_t i = 0; i < state.x.size(); ++i)
      n_there += (after.x[i] - goals[i]).norm() < 1e-3 * (state.x[i] - goals[i]).norm() ? 1 : 0;
    EXPECT_GE(n_there, 10u);
  }
}

/// Off its goal by a cube, a corner over a skin that is 1e-3 cubes deep is back after 20 steps: (1 + n r) (1 - r)^n of
/// it is left, r = sqrt(alpha). As a corner with mass does, it would swing on and on.
TEST(Riders, ComeBackWithoutSwinging) {
  const support::Body body = shallow_block(1e-3);
  const double dt = 1e-3, alpha = 0.2;
  const Matching model(body, {.density = 1000, .half_width = 2, .stiffness = alpha / (dt * dt)});
  EXPECT_EQ(model.riders().n_riders(), 6u * 5u * 5u - 4u * 3u * 3u) << "all but the nodes";
  ShapeMatching stepper(model, 0);
  dynamics::State state{grid::rest_positions(body), Points(body.complex.n_corners(), Vec3::Zero()), 0};
  const auto mass = model.lumped_mass();
  const auto lightest = static_cast<std::size_t>(std::min_element(mass.begin(), mass.end()) - mass.begin());
  const Vec3 goal = state.x[lightest];
  state.x[lightest] += Vec3(0, 0, 1);
  double most_beyond = 0;
  for (int i = 0; i < 20; ++i) {
    stepper.step(state, {}, dt);
    most_beyond = std::max(most_beyond, goal[2] - state.x[lightest][2]);
  }
  const double r = std::sqrt(alpha);
  EXPECT_LT((state.x[lightest] - goal).norm(), (1 + 20 * r) * std::pow(1 - r, 20) + 1e-4);
  EXPECT_LT(most_beyond, 1e-4);
}

} // namespace
} // namespace kerf::lattice::riders_test
