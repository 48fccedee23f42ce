#include "cut/moving_edge.h"

#include "geometry/predicates.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <numbers>
#include <random>

namespace kerf::cut::moving_edge_test {
namespace {

/// Long beside what it cuts: 0.4 m on either side, and turned by 20 degrees as it sinks by 0.05 m.
Blade turning_blade() {
  return {.name = "turner",
          .edge = {{-0.4, 0.02, 0}, {0.4, 0.02, 0}},
          .key_frames = {{0, {0, 0, 0.05}, {0, 0, 0}}, {1, {0, 0, 0}, {0, 0, 20}}}};
}

/// Of a blade that has no key frame within the step.
BladePath only_path(const Blade& blade, const double t0, const double t1) {
  const auto all = paths(blade, t0, t1);
  EXPECT_EQ(all.size(), 1u);
  return all.at(0);
}

class MovingEdge : public testing::Test {
 protected:
  Vec3 random_point(const double reach) {
    std::uniform_real_distribution<double> coordinate(-reach, reach);
    const double x = coordinate(random_), y = coordinate(random_), z = coordinate(random_);
    return {x, y, z};
  }

  std::mt19937 random_{3};
};

TEST_F(MovingEdge, AtRestIsCrossedLikeByTheStrip) {
  const Blade blade = turning_blade();
  const BladePath whole = only_path(blade, 0, 1);
  const auto strip = sweep(blade, 0, 1);
  std::size_t n_met = 0;
  for (int n = 0; n < 2000; ++n) {
    const Segment segment = {random_point(0.1), random_point(0.1)};
    const auto n_crossings = static_cast<std::size_t>(std::count_if(
      strip.begin(), strip.end(), [&](const auto& t) { return geometry::crosses(segment[0], segment[1], t); }));
    EXPECT_EQ(meet(whole, segment, segment).n_crossings, n_crossings);
    n_met += n_crossings > 0 ? 1 : 0;
  }
  EXPECT_GT(n_met, 200u);
}

/// What moves with the blade is not met; what moves the other way is met where the two motions say.
TEST_F(MovingEdge, IsMetInRelativeMotion) {
  const Blade blade{.name = "knife",
                    .edge = {{0, -1, 0}, {0, 1, 0}},
                    .key_frames = {{0, {0, 0, 0}, Vec3::Zero()}, {1, {1, 0, 0}, Vec3::Zero()}}};
  const BladePath step = only_path(blade, 0, 1);
  const Segment before = {Vec3(0.5, 0, -1), Vec3(0.5, 0, 3)};
  const auto moved = [&](const Vec3& by) { return Segment{before[0] + by, before[1] + by}; };
  EXPECT_EQ(meet(step, before, before).n_crossings, 1u);
  EXPECT_EQ(meet(step, before, moved({1, 0, 0})).n_crossings, 0u);
  EXPECT_EQ(meet(step, before, moved({0.4, 0, 0})).n_crossings, 1u); // at 5 / 6 of the step
  EXPECT_EQ(meet(step, before, moved({0.6, 0, 0})).n_crossings, 0u); // not before its end
  const Verdict verdict = meet(step, before, moved({-1, 0, 2}));     // at 1 / 4 of the step, when it is 0.5 m higher
  EXPECT_EQ(verdict.n_crossings, 1u);
  EXPECT_NEAR(verdict.t, 0.5 / 4, 1e-12);
  const auto normal = [](const Verdict& of, const Vec3& motion) -> Vec3 {
    return (of.normal - of.along.cross(motion)).normalized();
  };
  EXPECT_NEAR(std::abs(normal(verdict, Vec3::Zero()).dot(Vec3::UnitZ())), 1, 1e-12); // in material that stands still
  EXPECT_NEAR(std::abs(normal(verdict, {-1, 0, 2}).dot(Vec3(1, 0, 1).normalized())), 1, 1e-12);
  const BladePath resting{{0, 1}, {step.lines[0], step.lines[0]}};
  const Vec3 back(-1, 0, 0);
  EXPECT_NEAR(std::abs(normal(meet(resting, before, moved(back)), back).dot(Vec3::UnitZ())), 1, 1e-12);
}

/// However the ends wander, a closed loop of segments meets a line that passes it an even number of times.
TEST_F(MovingEdge, ALoopIsMetEvenly) {
  const Blade blade = turning_blade();
  std::size_t n_met = 0;
  for (int n = 0; n < 500; ++n) {
    std::array<Vec3, 4> before, now;
    for (int i = 0; i < 4; ++i)
      before[i] = random_point(0.1);
    std::array<std::size_t, 4> sums = {};
    for (int step = -4; step < 12; ++step) { // the blade comes from above all of them, and goes below all of them
      for (int i = 0; i < 4; ++i)
        now[i] = random_point(0.1);
      Blade falling = blade;
      falling.key_frames = {{0, {0, 0, 0.3}, {0, 0, 0}}, {1, {0, 0, -0.3}, {0, 0, 20}}};
      const BladePath part = only_path(falling, step / 8.0, (step + 1) / 8.0);
      for (int i = 0; i < 4; ++i)
        sums[i] += meet(part, {before[i], before[(i + 1) % 4]}, {now[i], now[(i + 1) % 4]}).n_crossings;
      before = now;
    }
    EXPECT_EQ((sums[0] + sums[1] + sums[2] + sums[3]) % 2, 0u);
    n_met += sums[0] % 2;
  }
  EXPECT_GT(n_met, 50u);
}

/// A long blade that turns sweeps a surface whose normal changes along it.
TEST_F(MovingEdge, TheNormalIsThatOfThePlaceThatIsMet) {
  const Blade blade = turning_blade();
  std::size_t n_met = 0;
  for (int n = 0; n < 500; ++n) {
    const Vec3 place = random_point(1), half = 0.02 * random_point(1);
    const Vec3 middle = pose(blade, 0.5 + 0.45 * place[0])({0.35 * place[1], 0.02, 0});
    const Vec3 p = middle - half, q = middle + half;
    const Verdict verdict = meet(only_path(blade, 0, 1), {p, q}, {p, q});
    if (verdict.n_crossings != 1)
      continue;
    ++n_met;
    const Vec3 at = p + verdict.t * (q - p);
    const double time = 1 - at[2] / 0.05, rate = 20 * std::numbers::pi / 180; // [rad/s]
    const Vec3 velocity = rate * Vec3::UnitZ().cross(at) + Vec3(0, 0, -0.05);
    const Vec3 wanted = (pose(blade, time).rotation * Vec3::UnitX()).cross(velocity).normalized();
    EXPECT_GT(std::abs(verdict.normal.normalized().dot(wanted)), std::cos(4 * std::numbers::pi / 180));
  }
  EXPECT_GT(n_met, 200u);
}

} // namespace
} // namespace kerf::cut::moving_edge_test
