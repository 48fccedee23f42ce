#include "cut/blade_edge.h"

#include "base/error.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <cmath>
#include <limits>
#include <numbers>

namespace kerf::cut::blade_edge_test {
namespace {

constexpr double pi = std::numbers::pi;

/// A turned and shifted plane: no axis is special.
Vec3 in_plane(const double x, const double y) {
  static const Mat3 R = Eigen::AngleAxisd(0.7, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
  return R * Vec3(x, y, 0) + Vec3(0.3, 0.1, -2);
}

Vec3 on_circle(const double radius, const double angle) {
  return in_plane(radius * std::cos(angle), radius * std::sin(angle));
}

double length(const Points& line) {
  double sum = 0;
  for (std::size_t i = 1; i < line.size(); ++i)
    sum += (line[i] - line[i - 1]).norm();
  return sum;
}

/// Half of a chord over half of an angle that is at most 5 degrees: shorter than the arc by less than 4e-4 of it.
void expect_arc(const double angle, const double part_at_middle) {
  SCOPED_TRACE("arc of " + std::to_string(angle) + " rad, the second point at " + std::to_string(part_at_middle));
  const double radius = 0.04;
  const Points given = {on_circle(radius, 0.3), on_circle(radius, 0.3 + part_at_middle * angle),
                        on_circle(radius, 0.3 + angle)};
  const Points line = arcs(given);
  EXPECT_EQ(line.front(), given.front());
  EXPECT_EQ(line.back(), given.back());
  EXPECT_EQ(line.size(), 1 + static_cast<std::size_t>(std::ceil(std::abs(angle) * 36 / pi - 1e-6)));
  for (const Vec3& p : line)
    EXPECT_NEAR((p - in_plane(0, 0)).norm(), radius, 1e-12);
  EXPECT_NEAR(length(line), radius * std::abs(angle), 4e-4 * radius * std::abs(angle));
  EXPECT_LT(length(line), radius * std::abs(angle));
  double nearest = 1;
  for (std::size_t i = 1; i < line.size(); ++i)
    nearest = std::min(nearest, (line[i] - given[1]).norm());
  EXPECT_LT(nearest, radius * 2.51 * pi / 180) << "it passes the second point";
}

TEST(BladeEdge, ThreePointsGiveTheArcThroughThem) {
  for (const double angle : {0.3, 1.0, pi / 2, pi, 4.0, 6.0, -0.3, -pi, -5.0})
    for (const double part : {0.5, 0.2, 0.9})
      expect_arc(angle, part);
}

TEST(BladeEdge, ArcsFollowEachOther) {
  const Points s = arcs({{0, 0, 0}, {1, 1, 0}, {2, 0, 0}, {3, -1, 0}, {4, 0, 0}});
  EXPECT_NEAR(length(s), 2 * pi, 1e-3 * 2 * pi);
  EXPECT_EQ(std::count(s.begin(), s.end(), Vec3(2, 0, 0)), 1);
  const Points circle = arcs({{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {1, 0, 0}});
  EXPECT_EQ(circle.size(), 73u);
  EXPECT_EQ(circle.front(), circle.back());
}

TEST(BladeEdge, PointsOnALineGiveASegment) {
  EXPECT_EQ(arcs({{0, 0, 0}, {1, 2, 3}, {3, 6, 9}}), Points({{0, 0, 0}, {3, 6, 9}}));
}

TEST(BladeEdge, SaysWhatIsNoArc) {
  const auto expect_refused = [](const Points& points, const std::string& part) {
    try {
      arcs(points);
      FAIL() << "accepted: " << part;
    } catch (const ParameterError& error) {
      const std::string message = error.what();
      EXPECT_NE(message.find(part), std::string::npos) << message;
      EXPECT_EQ(error.complaint().path, "Edge [m]");
      EXPECT_FALSE(error.complaint().remedy.empty());
    }
  };
  expect_refused({}, "must have three points");
  expect_refused({{0, 0, 0}, {1, 0, 0}}, "must have three points");
  expect_refused({{0, 0, 0}, {1, 1, 0}, {2, 0, 0}, {3, 1, 0}}, "'4 points'");
  expect_refused({{0, 0, 0}, {0, 0, 0}, {2, 0, 0}}, "three different points");
  expect_refused({{0, 0, 0}, {1, 1, 0}, {0, 0, 0}}, "three different points");
  expect_refused({{0, 0, 0}, {1, 1, 0}, {2, 0, 0}, {3, 1, 0}, {3, 1, 0}}, "'arc 2'");
  expect_refused({{0, 0, 0}, {3, 0, 0}, {2, 0, 0}}, "not between the others");
  expect_refused({{0, 0, 0}, {1, 1, 0}, {2, std::numeric_limits<double>::quiet_NaN(), 0}}, "finite");
}

} // namespace
} // namespace kerf::cut::blade_edge_test
