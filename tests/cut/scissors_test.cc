#include "cut/scissors.h"

#include "base/error.h"
#include "geometry/predicates.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <functional>
#include <limits>
#include <numbers>
#include <random>

namespace kerf::cut::scissors_test {
namespace {

constexpr double pi = std::numbers::pi;
using Strip = std::vector<std::array<Vec3, 3>>;

/// Close along the x axis, in the plane z = 0 of their frame.
Scissors moving_scissors() {
  return {.name = "shears",
          .pivot = {-0.1, 0, 0},
          .edges = {Points{{0, 0, 0}, {0.5, 0, 0}, {1, 0, 0}}, Points{{0, 0, 0}, {0.5, 0, 0}, {1, 0, 0}}},
          .openings = {{0, 60}, {1, 60}, {3, 0}, {4, 30}},
          .key_frames = {{0, {0, 0, 0}, {0, 0, 0}}, {2, {1, 0, 2}, {0, 80, 90}}, {5, {3, 1, 2}, {40, 20, 100}}}};
}

/// The same without motion of the whole.
Scissors resting_scissors() {
  Scissors scissors = moving_scissors();
  scissors.key_frames = {{0, {0.2, 0.3, 0.4}, {20, 10, -40}}};
  return scissors;
}

double area(const Strip& strip) {
  double sum = 0;
  for (const auto& [a, b, c] : strip)
    sum += (b - a).cross(c - a).norm() / 2;
  return sum;
}

TEST(Scissors, OpenByHalfTheAngleEach) {
  const Scissors scissors = moving_scissors();
  const auto both = blades(scissors, 7);
  EXPECT_EQ(both[0].label, 7);
  EXPECT_EQ(both[1].label, 8);
  for (const double t : {-1.0, 0.5, 1.3, 2.9, 3.5, 9.0}) {
    const Pose whole = pose(scissors.key_frames, t);
    const double opening = t < 1 ? 60 : t < 3 ? 30 * (3 - t) : t < 4 ? 30 * (t - 3) : 30;
    for (int i = 0; i < 2; ++i) {
      const Pose placed = pose(both[i], t);
      EXPECT_LT((placed(scissors.pivot) - whole(scissors.pivot)).norm(), 1e-14) << "the pivot is shared";
      const double angle = (i == 0 ? 0.5 : -0.5) * opening * pi / 180;
      const Vec3 tip = scissors.pivot + 1.1 * Vec3(std::cos(angle), std::sin(angle), 0);
      EXPECT_LT((placed({1, 0, 0}) - whole(tip)).norm(), 1e-14);
    }
  }
}

TEST(Scissors, MeetBitByBitWhenClosed) {
  const auto both = blades(moving_scissors(), 1);
  EXPECT_EQ(world_points(both[0], 3), world_points(both[1], 3));
  EXPECT_NE(world_points(both[0], 2.9), world_points(both[1], 2.9));
}

TEST(Scissors, SweepTheSectorBetweenThem) {
  const auto both = blades(resting_scissors(), 1);
  const double sector = 0.5 * (60 * pi / 180) * (1.1 * 1.1 - 0.1 * 0.1);
  EXPECT_NEAR(area(sweep(both[0], 0, 3)) + area(sweep(both[1], 0, 3)), sector, 3e-4 * sector);
  EXPECT_TRUE(sweep(both[0], 0, 1).empty()) << "nothing moves before";
  EXPECT_TRUE(sweep(both[0], 4, 6).empty()) << "or after";
  EXPECT_EQ(sweep(both[0], 1, 3).size(), 15u * 2 * 2) << "2 degrees a strip";
}

std::size_t n_crossed(const Strip& strip, const Vec3& p, const Vec3& q) {
  return std::count_if(strip.begin(), strip.end(), [&](const auto& t) { return geometry::crosses(p, q, t); });
}

/// However the closing is divided into steps, what lies between the blades is crossed exactly once, be it on the very
/// line where they meet.
TEST(Scissors, LeaveNoGapWhereTheyMeet) {
  Scissors scissors = resting_scissors();
  scissors.key_frames = {{0, Vec3::Zero(), Vec3::Zero()}};
  const auto both = blades(scissors, 1);
  std::mt19937 random(11);
  std::uniform_real_distribution<double> along(0.05, 0.95), across(-29, 29), tilt(-0.2, 0.2);
  for (int n = 0; n < 300; ++n) {
    const double r = 0.1 + along(random), angle = n % 3 == 0 ? 0 : across(random) * pi / 180;
    const Vec3 middle = scissors.pivot + r * Vec3(std::cos(angle), std::sin(angle), 0);
    const Vec3 half = n % 2 == 0 ? Vec3(0, 0, 0.1) : Vec3(0, tilt(random), 0.1);
    std::size_t n_crossings = 0;
    for (int step = 0; step < 17; ++step)
      for (const Blade& blade : both)
        n_crossings +=
          n_crossed(sweep(blade, 1 + step * 2.0 / 17, 1 + (step + 1) * 2.0 / 17), middle - half, middle + half);
    EXPECT_EQ(n_crossings, 1u) << "at " << r << " m, " << angle << " rad";
  }
}

TEST(Scissors, CutOnlyWhileTheyClose) {
  const Blade blade = blades(moving_scissors(), 1)[0]; // closes from 1 to 3 s, opens from 3 to 4 s, moves until 5 s
  EXPECT_TRUE(sweep(blade, 0, 1).empty()) << "carried along, open";
  EXPECT_TRUE(sweep(blade, 3, 4).empty()) << "opens";
  EXPECT_TRUE(sweep(blade, 4, 5).empty()) << "carried along";
  EXPECT_TRUE(paths(blade, 3, 4).empty());
  const auto closing = paths(blade, 0.5, 3.5); // the whole has a key frame at 2 s
  ASSERT_EQ(closing.size(), 2u);
  EXPECT_EQ(closing[0].lines.front(), world_points(blade, 1));
  EXPECT_EQ(closing[0].lines.back(), world_points(blade, 2));
  EXPECT_EQ(closing[1].lines.front(), world_points(blade, 2));
  EXPECT_EQ(closing[1].lines.back(), world_points(blade, 3));
  EXPECT_NEAR(closing[0].fractions.front(), 0.5 / 3, 1e-15);
  EXPECT_NEAR(closing[0].fractions.back(), 1.5 / 3, 1e-15);
  EXPECT_NEAR(closing[1].fractions.front(), 1.5 / 3, 1e-15);
  EXPECT_NEAR(closing[1].fractions.back(), 2.5 / 3, 1e-15);
}

/// What they sweep as they close does not depend on what else they do in the step.
TEST(Scissors, CutEachTimeTheyCloseInAStep) {
  Scissors scissors = resting_scissors();
  scissors.openings = {{0, 80}, {1, 0}, {2, 80}, {3, 20}};
  const Blade blade = blades(scissors, 1)[0];
  const auto closing = paths(blade, 0, 3);
  ASSERT_EQ(closing.size(), 2u);
  EXPECT_EQ(closing[0].lines, paths(blade, 0, 1).at(0).lines);
  EXPECT_EQ(closing[1].lines, paths(blade, 2, 3).at(0).lines);
}

TEST(Scissors, CheckNamesWhatIsWrong) {
  const auto expect_refused = [](const std::function<void(Scissors&)>& spoil, const std::string& part) {
    Scissors scissors = moving_scissors();
    spoil(scissors);
    try {
      blades(scissors, 1);
      FAIL() << "accepted: " << part;
    } catch (const ParameterError& error) {
      const std::string message = error.what();
      EXPECT_NE(message.find(part), std::string::npos) << message;
      EXPECT_NE(message.find("shears"), std::string::npos) << message;
      EXPECT_FALSE(error.complaint().remedy.empty());
    }
  };
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  expect_refused([](Scissors& s) { s.openings[0].angle = -1; }, "must be >= 0 and < 180");
  expect_refused([](Scissors& s) { s.openings[1].angle = 180; }, "must be >= 0 and < 180");
  expect_refused([](Scissors& s) { s.openings[1].angle = nan; }, "must be >= 0 and < 180");
  expect_refused([](Scissors& s) { s.openings[1].time = nan; }, "finite time");
  expect_refused([](Scissors& s) { s.openings.clear(); }, "at least one angle");
  expect_refused([](Scissors& s) { s.openings[1].time = 0; }, "times must increase");
  expect_refused([](Scissors& s) { s.openings[1].time = 3.5; }, "times must increase");
  expect_refused([](Scissors& s) { s.axis.setZero(); }, "must be a direction");
  expect_refused([](Scissors& s) { s.pivot[0] = nan; }, "finite");
  expect_refused([](Scissors& s) { s.edges[0].resize(1); }, "at least two points");
  expect_refused([](Scissors& s) { s.edges[1][1] = s.edges[1][0]; }, "shears second/Edge [m]");
  expect_refused([](Scissors& s) { s.key_frames.clear(); }, "at least one key frame");
  expect_refused([](Scissors& s) { s.key_frames[1].time = 9; }, "times must increase");
}

} // namespace
} // namespace kerf::cut::scissors_test
