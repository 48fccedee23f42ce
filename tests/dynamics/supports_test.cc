/// Supports that hold some directions, together and in conflict, under every integrator.

#include "base/error.h"
#include "dynamics/constraints.h"
#include "dynamics/preconditioner.h"
#include "tests/dynamics/chain.h"
#include "tests/dynamics/integrators.h"

#include <Eigen/Geometry>

#include <gtest/gtest.h>

namespace kerf::dynamics::supports_test {
namespace {

Vec3 still(double) { return Vec3::Zero(); }

Support support_of(const Chain& model, const std::uint32_t corner, const Mat3& held) {
  return {{corner}, {model.rest()[corner]}, still, {}, held};
}

/// Key frames that lie as close as steps lead a body as the smooth motion does that they are taken from, with damping
/// too: where a balance lies between two times, so do velocities.
TEST(Integrators, FollowKeyFramesAsTheSmoothMotion) {
  constexpr double dt = 0.01;
  const auto smooth = [](const double t) { return Vec3(0, 0, 0.4 * t * t); };
  const auto polygon = [&](const double t) {
    const double k = std::floor(t / dt), part = t / dt - k;
    return Vec3((1 - part) * smooth(k * dt) + part * smooth((k + 1) * dt));
  };
  for (std::size_t which = 5; which <= 9; ++which) { // Newmark and generalised alpha
    Points ends;
    for (const bool is_smooth : {true, false}) {
      Chain model({1, 2}, {.neighbour = 300});
      Loads loads{.stiffness_damping = 0.02, .supports = {}};
      loads.supports = {support_of(model, 0, Mat3::Identity())};
      loads.supports[0].displacement = is_smooth ? std::function<Vec3(double)>(smooth) : polygon;
      State state = model.state();
      const auto stepper = integrators()[which].make(model);
      for (int i = 0; i < 50; ++i)
        stepper->step(state, loads, dt);
      ends.push_back(state.x[1]);
    }
    EXPECT_LT((ends[0] - ends[1]).norm(), 1e-9) << integrators()[which].name;
  }
}

TEST(Constraints, CombineWhatSupportsHold) {
  Chain model({1, 1, 1, 1}, {});
  Loads loads;
  loads.supports = {support_of(model, 1, held_axes("x")), support_of(model, 1, held_along(Vec3(0, 3, 4))),
                    support_of(model, 2, held_axes("xy")), support_of(model, 2, held_axes("yz")),
                    support_of(model, 3, held_along(Vec3(1, 1, 1)))};
  const Constraints constraints(loads, 4);
  EXPECT_TRUE(constraints.is_free(0));
  EXPECT_EQ(constraints.freedom(1).n_free, 1);
  EXPECT_LT((constraints.freedom(1).project * Vec3(0, -4, 3) - Vec3(0, -4, 3)).norm(), 1e-14);
  EXPECT_EQ(constraints.freedom(2).n_free, 0);
  EXPECT_EQ(constraints.freedom(3).n_free, 2);
  EXPECT_EQ(constraints.n_free(), 3u + 1 + 0 + 2);
  Points x(4, Vec3(0.7, 0.8, 0.9));
  constraints.place(0, x);
  EXPECT_EQ(x[0], Vec3(0.7, 0.8, 0.9));
  EXPECT_NEAR(x[1][0], model.rest()[1][0], 1e-15);
  EXPECT_NEAR(Vec3(0, 3, 4).dot(x[1] - model.rest()[1]), 0, 1e-14);
  EXPECT_NEAR(Vec3(0, -4, 3).dot(x[1] - Vec3(0.7, 0.8, 0.9)), 0, 1e-14);
  EXPECT_LT((x[2] - model.rest()[2]).norm(), 1e-14);
  EXPECT_NEAR((x[3] - model.rest()[3]).sum(), 0, 1e-14);
}

/// Of blocks that single precision can tell, of those that are too narrow for it, and of numbers that it does not have.
TEST(Constraints, InverseFactorsInSinglePrecisionAreThoseInDouble) {
  const Constraints free_everywhere(Loads{}, 1);
  const Mat3 turned = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  for (const Vec3& eigenvalues :
       {Vec3(1, 2, 3), Vec3(1e9, 2e9, 3e8), Vec3(1, 1e-2, 1e-4), Vec3(1, 1, 1e-7), Vec3(1, 1e-9, 1e-12)}) {
    const Mat3 block = turned * eigenvalues.asDiagonal() * turned.transpose();
    const Mat3 S = inverse_factor(block, free_everywhere.freedom(0));
    const Mat3 in_single = inverse_factor_in_single(block, free_everywhere.freedom(0)).cast<double>();
    EXPECT_LT((in_single - S).norm(), 2e-4 * S.norm()) << eigenvalues.transpose();
    EXPECT_LT((S * block * S.transpose() - Mat3::Identity()).norm(), 1e-4) << eigenvalues.transpose();
  }
  for (const double large : {1e39, 1e200})
    for (int k = 0; k < 3; ++k) {
      Mat3 block = Mat3::Identity();
      block(k, k) = large;
      const Mat3 in_single = inverse_factor_in_single(block, free_everywhere.freedom(0)).cast<double>();
      EXPECT_NEAR(in_single(k, k), 1 / std::sqrt(large), 1e-6 / std::sqrt(large) + 1e-40) << large << ", " << k;
      EXPECT_NEAR(in_single((k + 1) % 3, (k + 1) % 3), 1, 1e-6);
    }
  const Mat3 semidefinite = Vec3(1, 1, 0).asDiagonal();
  EXPECT_TRUE(inverse_factor_in_single(semidefinite, free_everywhere.freedom(0)).allFinite());
}

TEST(Constraints, WordsAreAxes) {
  EXPECT_EQ(held_axes("all"), Mat3(Mat3::Identity()));
  EXPECT_EQ(held_axes("xz"), Mat3(Vec3(1, 0, 1).asDiagonal()));
  for (const std::string& word : hold_words()) {
    const Mat3 H = held_axes(word);
    EXPECT_EQ(Mat3(H * H), H);
    EXPECT_GT(H.trace(), 0);
  }
}

TEST(Constraints, FindContradictions) {
  Chain model({1, 1, 1}, {});
  Loads loads;
  loads.supports = {support_of(model, 1, held_axes("x")), support_of(model, 1, held_axes("y"))};
  loads.supports[1].displacement = [](const double t) { return Vec3(t, t, t); };
  EXPECT_FALSE(find_contradiction(loads, 1, 1e-9)); // they hold different directions
  loads.supports.push_back(support_of(model, 1, held_along(Vec3(1, 1, 0))));
  EXPECT_FALSE(find_contradiction(loads, 0, 1e-9));
  const auto found = find_contradiction(loads, 0.5, 1e-9); // x holds 0, but x + y of another moves with y
  EXPECT_FALSE(found);                                     // any two of the three agree somewhere
  loads.supports.push_back(support_of(model, 1, Mat3::Identity()));
  const auto both = find_contradiction(loads, 0.5, 1e-9);
  ASSERT_TRUE(both);
  EXPECT_EQ(both->first, 1u);
  EXPECT_EQ(both->second, 3u);
  EXPECT_EQ(both->corner, 1u);
  EXPECT_NEAR(both->distance, 0.5, 1e-12);
}

class Held : public testing::TestWithParam<Integrator> {};

/// A mass on a slope that is no axis: it slides with g sin, as free as along a line.
TEST_P(Held, SlidesAlongAPlane) {
  Chain model({2}, {});
  State state = model.state();
  const Vec3 normal = Vec3(1, 2, 3).normalized(), g(0, 0, -10);
  Loads loads{.gravity = g, .supports = {}};
  loads.supports = {support_of(model, 0, held_along(normal))};
  const auto stepper = GetParam().make(model);
  const Vec3 along = g - g.dot(normal) * normal;
  for (int i = 0; i < 100; ++i)
    stepper->step(state, loads, 0.01);
  EXPECT_LT((state.v[0] - along).norm(), 1e-9 + (GetParam().name == "BDF2" ? 0.1 : 0));
  EXPECT_LT((state.x[0] - 0.5 * along).norm(), 0.06);
  EXPECT_LT(std::abs(state.x[0].dot(normal)), 1e-12);
  EXPECT_LT(std::abs(state.v[0].dot(normal)), 1e-9);
}

/// Held in x alone, a pendulum of springs swings in y and z as if it were held nowhere else.
TEST_P(Held, OnlyWhatIsHeld) {
  Chain model({1, 1}, {.anchor = 5, .neighbour = 20});
  const auto run = [&](const Loads& loads) {
    State state = model.state();
    state.v[1] = Vec3(0, 0.3, -0.2);
    const auto stepper = GetParam().make(model);
    for (int i = 0; i < 50; ++i)
      stepper->step(state, loads, 0.02);
    return state;
  };
  Loads held;
  held.supports = {support_of(model, 0, held_axes("x"))};
  const State a = run({}), b = run(held);
  for (int i = 0; i < 2; ++i)
    EXPECT_LT((a.x[i] - b.x[i]).norm() + (a.v[i] - b.v[i]).norm(), 1e-11);
}

/// A turned region goes where it is turned; what hangs on it by a stiff spring follows.
TEST_P(Held, FollowsARotation) {
  Chain model({1, 1}, {.neighbour = 100});
  State state = model.state();
  Loads loads{.mass_damping = 5, .supports = {}};
  const auto turn = [](const double t) { return Mat3(Eigen::AngleAxisd(t, Vec3::UnitZ())); };
  loads.supports = {{{1}, {model.rest()[1]}, still, turn}};
  const auto stepper = GetParam().make(model);
  for (int i = 0; i < 100; ++i) {
    stepper->step(state, loads, 0.01);
    EXPECT_LT((state.x[1] - turn(state.time) * model.rest()[1]).norm(), 1e-14);
    EXPECT_LT((state.v[1] - Vec3::UnitZ().cross(state.x[1])).norm(), 1e-3); // of Euler: the mean over the step
  }
}

INSTANTIATE_TEST_SUITE_P(All, Held, testing::ValuesIn(integrators()), [](const auto& info) { return info.param.name; });

} // namespace
} // namespace kerf::dynamics::supports_test
