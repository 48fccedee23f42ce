#include "cut/blade.h"

#include "base/error.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <functional>
#include <limits>
#include <numbers>

namespace kerf::cut::blade_test {
namespace {

Blade turning_blade() {
  return {.name = "hook",
          .edge = {{0, 0, 0}, {1, 0, 0}, {1.5, 0.5, 0.1}},
          .key_frames = {{0, {0, 0, 0}, {0, 0, 0}},
                         {1, {1, 0, 2}, {0, 0, 90}},
                         {2, {1, 0, 2}, {0, 0, 90}},
                         {4, {3, 1, 2}, {40, 20, 100}}}};
}

double area(const std::vector<std::array<Vec3, 3>>& strip) {
  double sum = 0;
  for (const auto& [a, b, c] : strip)
    sum += (b - a).cross(c - a).norm() / 2;
  return sum;
}

TEST(Blade, PoseFollowsKeyFrames) {
  const Blade blade = turning_blade();
  EXPECT_EQ(pose(blade, -1).position, Vec3::Zero());
  EXPECT_EQ(pose(blade, -1).rotation, Mat3::Identity());
  EXPECT_EQ(pose(blade, 9).position, Vec3(3, 1, 2));
  EXPECT_TRUE(pose(blade, 0.5).position.isApprox(Vec3(0.5, 0, 1)));
  const Mat3 half_way = Eigen::AngleAxisd(std::numbers::pi / 4, Vec3::UnitZ()).toRotationMatrix();
  EXPECT_TRUE(pose(blade, 0.5).rotation.isApprox(half_way));
  EXPECT_TRUE(pose(blade, 1)({1, 0, 0}).isApprox(Vec3(1, 1, 2)));
  EXPECT_TRUE((pose(blade, 3).rotation * pose(blade, 3).rotation.transpose()).isApprox(Mat3::Identity()));
}

TEST(Blade, TurnsByMoreThanACircleFollowTheirVectors) {
  Blade blade = turning_blade();
  blade.key_frames = {{0, Vec3::Zero(), {0, 0, 0}},
                      {1, Vec3::Zero(), {0, 0, 170}},
                      {2, Vec3::Zero(), {0, 0, 340}},
                      {3, Vec3::Zero(), {0, 0, 500}}};
  check(blade);
  for (double t = 0; t < 2; t += 0.1)
    EXPECT_TRUE(pose(blade, t)({1, 0, 0}).isApprox(
      Vec3(std::cos(t * 170 * std::numbers::pi / 180), std::sin(t * 170 * std::numbers::pi / 180), 0)));
}

TEST(Blade, NoSweepAtRest) {
  const Blade blade = turning_blade();
  EXPECT_TRUE(sweep(blade, -2, 0).empty());
  EXPECT_TRUE(sweep(blade, 1, 2).empty());
  EXPECT_TRUE(sweep(blade, 1.25, 1.7).empty());
  EXPECT_TRUE(sweep(blade, 4, 6).empty());
  EXPECT_TRUE(sweep(blade, 0.5, 0.5).empty());
  EXPECT_FALSE(sweep(blade, -1, 0.01).empty());
}

TEST(Blade, SubStepsTurnByTwoDegrees) {
  const auto strip = sweep(turning_blade(), 0, 1);
  EXPECT_EQ(strip.size(), 45u * 2 * 2);
  Blade disk{.name = "disk",
             .edge = {{0, 0, 0}, {1, 0, 0}},
             .key_frames = {{0, Vec3::Zero(), {0, 0, 0}}, {1, Vec3::Zero(), {0, 0, 120}}}};
  EXPECT_NEAR(area(sweep(disk, 0, 1)) / (std::numbers::pi / 3), 1, 3e-4);
}

TEST(Blade, ConsecutiveSweepsShareTheirVertices) {
  const Blade blade = turning_blade();
  Points end;
  for (double t = -0.3; t < 4.5; t += 0.1) {
    const auto strip = sweep(blade, t, t + 0.1);
    const Points expected_start = world_points(blade, t), expected_end = world_points(blade, t + 0.1);
    ASSERT_TRUE(end.empty() || end == expected_start);
    if (!strip.empty()) {
      const std::size_t n_segments = blade.edge.size() - 1;
      ASSERT_EQ(strip[strip.size() - 2][2], expected_end.back());
      ASSERT_EQ(strip.back()[2], expected_end[n_segments - 1]);
      ASSERT_EQ(strip.size() % (2 * n_segments), 0u);
    }
    end = expected_end;
  }
}

/// Inside a strip every edge but the rim belongs to two triangles.
TEST(Blade, StripsHaveNoSeams) {
  const Blade blade = turning_blade();
  const auto strip = sweep(blade, 0.2, 3.3);
  const auto n_with_edge = [&](const Vec3& a, const Vec3& b) {
    return std::count_if(strip.begin(), strip.end(), [&](const auto& t) {
      return std::count(t.begin(), t.end(), a) == 1 && std::count(t.begin(), t.end(), b) == 1;
    });
  };
  std::size_t n_rim = 0;
  for (const auto& t : strip)
    for (int k = 0; k < 3; ++k) {
      const auto n = n_with_edge(t[k], t[(k + 1) % 3]);
      ASSERT_GE(n, 1);
      ASSERT_LE(n, 2);
      n_rim += n == 1 ? 1 : 0;
    }
  const std::size_t n_steps = strip.size() / 4;
  EXPECT_EQ(n_rim, 2 * n_steps + 2 * 2);
}

TEST(Blade, CheckNamesWhatIsWrong) {
  EXPECT_NO_THROW(check(turning_blade()));
  const auto expect_refused = [](const std::function<void(Blade&)>& spoil, const std::string& part) {
    Blade blade = turning_blade();
    spoil(blade);
    try {
      check(blade);
      FAIL() << "accepted: " << part;
    } catch (const ParameterError& error) {
      const std::string message = error.what();
      EXPECT_NE(message.find(part), std::string::npos) << message;
      EXPECT_EQ(message.find("Blade hook/"), 0u) << message;
    }
  };
  expect_refused([](Blade& b) { b.edge.resize(1); }, "at least two points");
  expect_refused([](Blade& b) { b.edge[1] = b.edge[0]; }, "must differ");
  expect_refused([](Blade& b) { b.edge[1][0] = std::numeric_limits<double>::quiet_NaN(); }, "finite");
  expect_refused([](Blade& b) { b.key_frames.clear(); }, "at least one key frame");
  expect_refused([](Blade& b) { b.key_frames[1].time = 0; }, "times must increase");
  expect_refused([](Blade& b) { b.key_frames[1].time = 3; }, "times must increase");
  expect_refused([](Blade& b) { b.key_frames[1].rotation = {0, 0, 190}; }, "less than 180 degrees");
  expect_refused([](Blade& b) { b.key_frames[2].position[1] = std::numeric_limits<double>::infinity(); }, "finite");
}

} // namespace
} // namespace kerf::cut::blade_test
