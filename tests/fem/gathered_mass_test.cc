/// Light corners without mass: what others get for it, and that they follow without a motion of their own.

#include "fem/gathered_mass.h"

#include "dynamics/followers.h"
#include "dynamics/forces.h"
#include "dynamics/generalised_alpha.h"
#include "tests/fem/models.h"

#include <gtest/gtest.h>

#include <numeric>

namespace kerf::fem::gathered_mass_test {
namespace {

constexpr double h = 0.2;

/// Rough skins and cuts anywhere: corners of every mass.
Body slivers(const unsigned seed) {
  Draw draw(seed);
  Body body = make_block({5, 4, 3}, h, draw, {1e-4, 0.98});
  cut_at_random(body, 0.1, draw, {1e-3, 0.98});
  return body;
}

double mass_of_cube(const material::Elastic& material) { return material.density * h * h * h; }

Vec3 moment(const std::span<const double> mass, const Points& rest) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < rest.size(); ++i)
    sum += mass[i] * rest[i];
  return sum;
}

double total(const std::span<const double> mass) { return std::accumulate(mass.begin(), mass.end(), 0.0); }

TEST(GatheredMass, KeepsMassAndItsCentreAndLeavesNoneAtLightCorners) {
  for (const unsigned seed : {1u, 2u, 3u}) {
    const Body body = slivers(seed);
    const material::Elastic material;
    const Hexahedra model(body, {.material = material});
    const auto mass = model.lumped_mass();
    const auto [gathered, followers] = gathered_mass(body, mass, mass_of_cube(material));
    const Points rest = body.rest();
    EXPECT_GT(followers.size(), 50u);
    EXPECT_NEAR(total(gathered), total(mass), 1e-12 * total(mass));
    EXPECT_LT((moment(gathered, rest) - moment(mass, rest)).norm(), 1e-12 * h * total(mass)) << seed;
    std::vector<std::uint8_t> follows(mass.size());
    for (const dynamics::Follower& follower : followers) {
      follows[follower.corner] = 1;
      EXPECT_LT(mass[follower.corner], mass_of_cube(material) / 128);
      EXPECT_EQ(gathered[follower.corner], 0);
    }
    for (std::size_t i = 0; i < mass.size(); ++i)
      EXPECT_TRUE(follows[i] || gathered[i] >= 0.45 * mass[i]) << i;
  }
}

TEST(GatheredMass, FollowersAreLedAffinely) {
  const Body body = slivers(4);
  const material::Elastic material;
  const Hexahedra model(body, {.material = material});
  const auto gathered = gathered_mass(body, model.lumped_mass(), mass_of_cube(material));
  const Points rest = body.rest();
  Draw draw(5);
  const Mat3 F = draw.matrix();
  Points x;
  for (const Vec3& X : rest)
    x.push_back(F * X + Vec3(1, 2, 3));
  std::size_t n_in_space = 0; // their leaders lie in no plane
  for (const dynamics::Follower& follower : gathered.followers) {
    EXPECT_NEAR(std::accumulate(follower.weights.begin(), follower.weights.end(), 0.0), 1, 1e-12);
    n_in_space += follower.n_leaders > 4 ? 1 : 0;
    if (follower.n_leaders > 4) {
      EXPECT_LT((follower.led(x) - x[follower.corner]).norm(), 1e-9);
    }
  }
  EXPECT_GT(n_in_space, 20u);
}

/// As one body: no step of any length leaves light corners behind, and none is deformed.
TEST(GatheredMass, FollowersFallWithTheOthers) {
  constexpr double dt = 0.02;
  constexpr int n = 10;
  for (const double rho : {-1.0, 0.8, 1.0}) { // -1: Newmark's
    const Body body = slivers(6);
    Hexahedra model(body, {.material = {.youngs_modulus = 1e5}, .inertia = Inertia::gathered});
    ASSERT_FALSE(model.followers().empty());
    dynamics::GeneralisedAlpha stepper(model, rho < 0 ? dynamics::newmark(0.25, 0.5) : dynamics::generalised_alpha(rho),
                                       {.max_iterations = 5, .cg_tolerance = 1e-12, .max_cg_iterations = 5000});
    dynamics::Loads loads;
    loads.gravity = Vec3(1, 2, -9);
    const Points rest = body.rest();
    dynamics::State state{rest, Points(rest.size(), Vec3::Zero())};
    for (int i = 0; i < n; ++i)
      stepper.step(state, loads, dt);
    const double t = n * dt;
    for (std::size_t i = 0; i < rest.size(); ++i) {
      EXPECT_LT((state.x[i] - rest[i] - 0.5 * t * t * loads.gravity).norm(), 1e-6 * h) << rho << ' ' << i;
      EXPECT_LT((state.v[i] - t * loads.gravity).norm(), 1e-5) << rho << ' ' << i;
    }
  }
}

/// A body that is stretched and let go: what pulls at light corners in the first step pulls at those that carry them.
TEST(GatheredMass, AFirstStepGivesNoMomentum) {
  for (const double rho : {-1.0, 0.8}) { // -1: Newmark's
    const Body body = slivers(8);
    Hexahedra model(body, {.material = {.youngs_modulus = 1e5}, .inertia = Inertia::gathered});
    ASSERT_FALSE(model.followers().empty());
    dynamics::GeneralisedAlpha stepper(model, rho < 0 ? dynamics::newmark(0.25, 0.5) : dynamics::generalised_alpha(rho),
                                       {.max_iterations = 100,
                                        .tolerance = 1e-10,
                                        .line_search = dynamics::LineSearch::backtracking,
                                        .cg_tolerance = 1e-12,
                                        .max_cg_iterations = 5000});
    dynamics::State state{body.rest(), Points(model.lumped_mass().size(), Vec3::Zero())};
    for (Vec3& x : state.x)
      x *= 1.1;
    const double energy = model.energy(state.x), mass = total(model.lumped_mass());
    for (int i = 0; i < 3; ++i) {
      stepper.step(state, {}, 0.01);
      EXPECT_LT(moment(model.lumped_mass(), state.v).norm(), 1e-6 * std::sqrt(2 * mass * energy)) << rho << ' ' << i;
    }
  }
}

/// Leaders that ring give their followers hardly more speed than they have, and leaders that turn that of the turn.
TEST(GatheredMass, LeadersThatRingGiveFollowersNoMore) {
  const Body body = slivers(9);
  const Hexahedra model(body, {.material = {}, .inertia = Inertia::gathered});
  const auto mass = model.lumped_mass();
  const Points rest = body.rest();
  Draw draw(10);
  const Vec3 u(1, 2, 3), omega(-2, 1, 4);
  Points rings, turns;
  for (const Vec3& X : rest) {
    turns.push_back(u + omega.cross(X));
    rings.push_back((draw.matrix() * X).normalized());
  }
  dynamics::lead_along(model, rest, turns);
  dynamics::lead_along(model, rest, rings);
  double fastest = 0, affine = 0;
  std::size_t n_in_space = 0;
  for (const dynamics::Follower& follower : model.followers()) {
    fastest = std::max(fastest, rings[follower.corner].norm());
    affine = std::max(affine, follower.led(rings).norm());
    n_in_space += follower.n_leaders > 4 ? 1 : 0; // the affine motion of a plane says nothing across it
    if (follower.n_leaders > 4) {
      EXPECT_LT((turns[follower.corner] - u - omega.cross(rest[follower.corner])).norm(), 1e-9) << follower.corner;
    }
  }
  EXPECT_GT(n_in_space, 20u);
  EXPECT_LT(fastest, 3);
  EXPECT_GT(affine, 3);
}

/// Put half a cube off, a light corner is back within a step and stays there, even where no vibration is damped.
TEST(GatheredMass, AFollowerDoesNotSwing) {
  const Body body = slivers(7);
  for (const double rho : {-1.0, 1.0}) { // -1: Newmark's
    Hexahedra model(body, {.material = {.youngs_modulus = 1e5}, .inertia = Inertia::gathered});
    dynamics::GeneralisedAlpha stepper(model, rho < 0 ? dynamics::newmark(0.25, 0.5) : dynamics::generalised_alpha(rho),
                                       {.max_iterations = 20,
                                        .tolerance = 1e-8,
                                        .line_search = dynamics::LineSearch::backtracking,
                                        .cg_tolerance = 1e-10,
                                        .max_cg_iterations = 5000});
    const Points rest = body.rest();
    const std::size_t corner = model.followers().front().corner;
    dynamics::State state{rest, Points(rest.size(), Vec3::Zero())};
    state.x[corner] += Vec3(0.5 * h, 0, 0);
    for (int i = 0; i < 5; ++i) {
      stepper.step(state, {}, 0.02);
      EXPECT_LT((state.x[corner] - rest[corner]).norm(), 0.04 * h) << rho << ' ' << i;
    }
  }
}

} // namespace
} // namespace kerf::fem::gathered_mass_test
