/// The stepper: what it keeps, what it survives, what it refuses.

#include "base/error.h"
#include "base/parallel.h"
#include "lattice/shape_matching.h"
#include "tests/lattice/bodies.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

namespace kerf::lattice::motion_test {
namespace {

constexpr double dt = 1.0 / 60;

struct Flying {
  Body body;
  Matching model;
  dynamics::State state;

  Flying(Body&& b, const ShapeMatchingParameters& parameters, const double noise)
    : body(std::move(b)), model(body, matching_options(parameters, 1000, dt)), state{body.rest(), {}, 0} {
    Draw draw(50);
    state.x = moved(body, draw, noise);
    for (const Vec3& x : state.x)
      state.v.push_back(Vec3(1, 2, 3) + Vec3(0, 0, 5).cross(x) + 2 * noise * draw.vector());
  }

  double total_energy() const { return model.energy(state.x) + kinetic_energy(model.lumped_mass(), state.v); }
};

TEST(ShapeMatching, KeepsBothMomenta) {
  for (const double region_damping : {0.0, 30.0}) {
    Flying f(cut_block(51, {5, 5, 5}, 0.3), {.half_width = 2}, 0.3);
    ShapeMatching stepper(f.model, region_damping);
    const Momentum before = momentum(f.model.lumped_mass(), f.state.x, f.state.v);
    for (int i = 0; i < 500; ++i)
      stepper.step(f.state, {.supports = {}}, dt);
    const Momentum after = momentum(f.model.lumped_mass(), f.state.x, f.state.v);
    double terms = 0; // of which the angular momentum about the origin is the sum; by now that is far away
    for (std::size_t c = 0; c < f.state.x.size(); ++c)
      terms += f.model.lumped_mass()[c] * f.state.x[c].norm() * f.state.v[c].norm();
    EXPECT_LT((after.linear - before.linear).norm(), 1e-12 * before.linear.norm()) << region_damping;
    EXPECT_LT((after.angular - before.angular).norm(), 1e-12 * terms) << region_damping;
  }
}

/// A translation is exact; a turn is symplectic Euler's, which is stretched by its own centrifugal force only.
TEST(ShapeMatching, CarriesRigidTranslation) {
  Flying f(cut_block(52, {4, 4, 4}, 0.3), {.half_width = 2}, 0);
  f.state.v.assign(f.state.x.size(), Vec3(0.3, -0.2, 0.1));
  const Points before = f.state.x;
  ShapeMatching stepper(f.model, 10);
  for (int i = 0; i < 600; ++i)
    stepper.step(f.state, {.supports = {}}, dt);
  for (std::size_t c = 0; c < before.size(); ++c)
    EXPECT_LT((f.state.x[c] - before[c] - 10 * Vec3(0.3, -0.2, 0.1)).norm(), 1e-10);
}

TEST(ShapeMatching, FallsAsGravityAndDampingSay) {
  Flying f(cut_block(53, {4, 4, 4}, 0.3), {.half_width = 2}, 0);
  f.state.v.assign(f.state.x.size(), Vec3::Zero());
  ShapeMatching stepper(f.model, 0);
  const double damping = 3;
  double v = 0;
  for (int i = 0; i < 60; ++i) {
    stepper.step(f.state, {.gravity = Vec3(0, 0, -9.81), .mass_damping = damping, .supports = {}}, dt);
    v = (v - 9.81 * dt) / (1 + damping * dt);
  }
  for (const Vec3& velocity : f.state.v)
    EXPECT_LT((velocity - Vec3(0, 0, v)).norm(), 1e-10);
}

TEST(ShapeMatching, HeldCornersGoWhereTheyAreTold) {
  Flying f(cut_block(54, {4, 4, 4}, 0.1), {.half_width = 2}, 0);
  f.state.v.assign(f.state.x.size(), Vec3::Zero());
  const Points rest = f.state.x;
  dynamics::Loads loads{.gravity = Vec3(0, 0, -9.81), .supports = {}};
  loads.supports.push_back({{0, 1, 2, 3}, {}, [](const double t) { return Vec3(0.1 * t, 0, 0); }});
  for (const auto c : loads.supports[0].corners)
    loads.supports[0].rest.push_back(rest[c]);
  ShapeMatching stepper(f.model, 5);
  for (int i = 0; i < 60; ++i)
    stepper.step(f.state, loads, dt);
  for (const auto c : loads.supports[0].corners) {
    EXPECT_LT((f.state.x[c] - rest[c] - Vec3(0.1, 0, 0)).norm(), 1e-12);
    EXPECT_LT((f.state.v[c] - Vec3(0.1, 0, 0)).norm(), 1e-9);
  }
}

TEST(ShapeMatching, CornersSlideWhereTheyAreNotHeld) {
  Flying f(cut_block(54, {4, 4, 4}, 0.1), {.half_width = 2}, 0);
  f.state.v.assign(f.state.x.size(), Vec3::Zero());
  const Points rest = f.state.x;
  dynamics::Loads loads{.gravity = Vec3(0, 1, -9.81), .supports = {}};
  loads.supports.push_back({{}, {}, [](double) { return Vec3(Vec3::Zero()); }});
  loads.supports[0].held = dynamics::held_along(Vec3::UnitZ());
  for (std::uint32_t c = 0; c < rest.size(); ++c) {
    loads.supports[0].corners.push_back(c);
    loads.supports[0].rest.push_back(rest[c]);
  }
  ShapeMatching stepper(f.model, 5);
  for (int i = 0; i < 60; ++i)
    stepper.step(f.state, loads, dt);
  for (std::size_t c = 0; c < rest.size(); ++c) {
    EXPECT_NEAR(f.state.x[c][2], rest[c][2], 1e-10);
    EXPECT_NEAR(f.state.v[c][1], 1, 1e-8);
  }
}

/// A constant force on one corner.
class Pull : public dynamics::Load {
 public:
  Pull(const std::size_t corner, const Vec3& force) : corner_(corner), force_(force) {}

  dynamics::Nature nature() const override { return dynamics::Nature::conservative; }
  double energy(double, const Points& x) const override { return -force_.dot(x[corner_]); }
  void add_force(const dynamics::Moment&, Points& forces) const override { forces[corner_] += force_; }
  void add_tangent(dynamics::Tangent, const dynamics::Moment&, double, dynamics::LoadTangent&) const override {}

 private:
  std::size_t corner_;
  Vec3 force_;
};

/// Also on a corner that hardly weighs anything, and nothing gets away from the body.
TEST(ShapeMatching, LoadsGiveTheirForceAndTorque) {
  Draw draw(62);
  Body sliver = fem::make_block({3, 3, 3}, 0.1, draw, {1e-9, 1e-9});
  Flying f(std::move(sliver), {.half_width = 1}, 0);
  f.state.v.assign(f.state.x.size(), Vec3::Zero());
  const auto mass = f.model.lumped_mass();
  const std::size_t lightest = std::min_element(mass.begin(), mass.end()) - mass.begin();
  ASSERT_LT(mass[lightest], 1e-20);
  const Vec3 force(0.1, 0.2, -0.3);
  dynamics::Loads loads{.supports = {}};
  loads.acting.push_back(std::make_unique<Pull>(lightest, force));
  ShapeMatching stepper(f.model, 0);
  for (int i = 0; i < 30; ++i) {
    const Momentum before = momentum(mass, f.state.x, f.state.v);
    const Vec3 at = f.state.x[lightest];
    stepper.step(f.state, loads, dt);
    const Momentum after = momentum(mass, f.state.x, f.state.v);
    EXPECT_LT((after.linear - before.linear - dt * force).norm(), 1e-12 * force.norm());
    EXPECT_LT((after.angular - before.angular - dt * at.cross(force)).norm(), 1e-12 * force.norm());
  }
  const Reference::Motion motion = Reference(f.body, 100, 1000).match_all(f.state.x);
  const Points rest = f.body.rest();
  for (std::size_t c = 0; c < rest.size(); ++c)
    EXPECT_LT((f.state.x[c] - motion(rest[c])).norm(), 0.1 * f.body.grid.h());
}

/// Kick and drift let the energy swing by a known part of it: with alpha = (omega dt)^2 <= 1 the sum E + T - dt v.dE/2
/// is constant for linear motion, and its last term is at most half of the rest.
TEST(ShapeMatching, EnergyStaysWithinItsSwing) {
  for (const double alpha : {0.1, 0.5, 1.0})
    for (const int w : {1, 3}) {
      Flying f(cut_block(55, {5, 5, 5}, 0.3), {.half_width = w, .alpha = alpha}, 0.05);
      for (std::size_t c = 0; c < f.state.x.size(); ++c)
        f.state.v[c] *= 0;
      const double before = f.total_energy();
      ShapeMatching stepper(f.model, 0);
      double most = 0;
      for (int i = 0; i < 5000; ++i) {
        stepper.step(f.state, {.supports = {}}, dt);
        most = std::max(most, f.total_energy());
      }
      const double swing = 0.5 * std::sqrt(alpha);
      EXPECT_LT(most, (1 + swing) / (1 - swing) * before * 1.05) << alpha << " " << w;
      EXPECT_GT(most, 0.3 * before);
    }
}

/// Kinetic energy of what is not the regions' rigid motion.
double shaking(const Flying& f) {
  Points u;
  f.model.rigid_velocities(f.state.x, f.state.v, u);
  for (std::size_t c = 0; c < u.size(); ++c)
    u[c] -= f.state.v[c];
  return kinetic_energy(f.model.lumped_mass(), u);
}

/// After a while the body turns as a rigid one, with all of its angular momentum.
TEST(ShapeMatching, DampingTakesShakingAndLeavesTurning) {
  Flying f(cut_block(56, {5, 5, 5}, 0.1), {.half_width = 2}, 0.1);
  for (std::size_t c = 0; c < f.state.v.size(); ++c)
    f.state.v[c] -= Vec3(1, 2, 3);
  const Momentum before = momentum(f.model.lumped_mass(), f.state.x, f.state.v);
  const double shaken = shaking(f);
  ShapeMatching stepper(f.model, 20);
  double energy = f.total_energy();
  for (int i = 0; i < 20; ++i) {
    for (int j = 0; j < 50; ++j)
      stepper.step(f.state, {.supports = {}}, dt);
    EXPECT_LT(f.total_energy(), 1.001 * energy);
    energy = f.total_energy();
  }
  EXPECT_LT(shaking(f), 1e-2 * shaken);
  const Momentum after = momentum(f.model.lumped_mass(), f.state.x, f.state.v);
  EXPECT_LT((after.linear - before.linear).norm(), 1e-11 * before.angular.norm());
  EXPECT_LT((after.angular - before.angular).norm(), 4e-12 * before.angular.norm());
}

/// The load's beta K v is the same as region damping beta k.
TEST(ShapeMatching, StiffnessDampingIsRegionDamping) {
  Flying a(cut_block(57, {4, 4, 4}, 0.1), {.half_width = 2}, 0.1),
    b(cut_block(57, {4, 4, 4}, 0.1), {.half_width = 2}, 0.1);
  ShapeMatching by_region(a.model, 0.01 * a.model.stiffness()), by_load(b.model, 0);
  for (int i = 0; i < 20; ++i) {
    by_region.step(a.state, {.supports = {}}, dt);
    by_load.step(b.state, {.stiffness_damping = 0.01, .supports = {}}, dt);
  }
  EXPECT_EQ(a.state.x, b.state.x);
}

/// A stepper and a model made again in the middle go on with the same bits.
TEST(ShapeMatching, RemadeItGoesOnWithTheSameBits) {
  Flying f(cut_block(58, {5, 5, 5}, 0.3), {.half_width = 2}, 0.3);
  dynamics::State other = f.state;
  ShapeMatching stepper(f.model, 10);
  for (int i = 0; i < 20; ++i)
    stepper.step(f.state, {.supports = {}}, dt);
  for (int i = 0; i < 20; ++i) {
    const Matching again(f.body, matching_options({}, 1000, dt));
    ShapeMatching(again, 10).step(other, {.supports = {}}, dt);
  }
  EXPECT_EQ(f.state.x, other.x);
  EXPECT_EQ(f.state.v, other.v);
}

TEST(ShapeMatching, OneAndTwoThreadsGiveTheSameBits) {
  std::array<dynamics::State, 2> states;
  for (const int n : {1, 2}) {
    set_n_threads(n);
    Flying f(cut_block(59, {17, 17, 17}, 0.1), {.half_width = 2}, 0.3);
    ShapeMatching stepper(f.model, 10);
    for (int i = 0; i < 3; ++i)
      stepper.step(f.state, {.gravity = Vec3(0, 0, -9.81), .supports = {}}, dt);
    states[n - 1] = f.state;
  }
  set_n_threads(1);
  EXPECT_EQ(states[0].x, states[1].x);
  EXPECT_EQ(states[0].v, states[1].v);
}

TEST(ShapeMatching, RefusesWhatIsNoParameter) {
  const auto refused = [](const ShapeMatchingParameters& parameters) -> std::string {
    try {
      check(parameters);
    } catch (const ParameterError& error) {
      return error.complaint().path + " " + error.complaint().rule;
    }
    return "";
  };
  EXPECT_EQ(refused({}), "");
  EXPECT_EQ(refused({.half_width = 0}), "Half width [cells] must be a whole number >= 1 and <= 1e6");
  EXPECT_EQ(refused({.alpha = 0}), "Alpha [1] must be > 0 and <= 1");
  EXPECT_EQ(refused({.alpha = 1.01}), "Alpha [1] must be > 0 and <= 1");
  EXPECT_EQ(refused({.alpha = std::nan("")}), "Alpha [1] must be > 0 and <= 1");
  EXPECT_EQ(refused({.region_damping = -1}), "Region damping [1/s] must be >= 0");
}

TEST(ShapeMatching, RefusesAStepTooLongForItsStiffness) {
  Flying f(cut_block(60, {2, 2, 2}, 0), {}, 0);
  ShapeMatching stepper(f.model, 0);
  EXPECT_NO_THROW(stepper.step(f.state, {.supports = {}}, dt));
  EXPECT_THROW(stepper.step(f.state, {.supports = {}}, 1.01 * dt), ParameterError);
}

TEST(ShapeMatching, SaysWhenNumbersAreNone) {
  Flying f(cut_block(61, {2, 2, 2}, 0), {}, 0);
  f.state.v[3][1] = std::numeric_limits<double>::quiet_NaN();
  const Points before = f.state.x;
  ShapeMatching stepper(f.model, 0);
  EXPECT_THROW(stepper.step(f.state, {.supports = {}}, dt), NumericalError);
  EXPECT_EQ(f.state.x, before);
  EXPECT_EQ(f.state.time, 0);
}

} // namespace
} // namespace kerf::lattice::motion_test
