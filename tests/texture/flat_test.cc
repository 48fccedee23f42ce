#include "texture/flat.h"
#include "tests/texture/probes.h"

#include <gtest/gtest.h>

#include <numeric>

namespace kerf::texture::flat_test {
namespace {

constexpr double pixel = 0.001;

/// Triangles of a strip along x whose points lie at heights z(x).
template <class Height>
std::vector<Corners> strip(const int n, const Height& height) {
  std::vector<Corners> triangles;
  const auto at = [&](const double x, const double y) { return Vec3(x * pixel, y * pixel, height(x) * pixel); };
  for (int i = 0; i < n; ++i) {
    triangles.push_back({at(5 * i, 0), at(5 * i + 5, 0), at(5 * i, 5)});
    triangles.push_back({at(5 * i + 5, 0), at(5 * i + 5, 5), at(5 * i, 5)});
  }
  return triangles;
}

std::vector<FlatGroup> groups_of(const std::vector<Corners>& triangles) {
  std::vector<std::size_t> numbers(triangles.size());
  std::iota(numbers.begin(), numbers.end(), 0);
  return flat_groups(numbers, triangles, Mat3::Identity(), Vec3::Zero(), pixel);
}

TEST(FlatGroups, JoinWhatLiesInNearlyOnePlane) {
  EXPECT_EQ(groups_of(strip(5, [](double) { return 0.0; })).size(), 1u);
  EXPECT_EQ(groups_of(strip(5, [](const double x) { return x; })).size(), 1u);
  EXPECT_EQ(groups_of(strip(5, [](const double x) { return 0.2 * std::sin(0.05 * x); })).size(), 1u);
  EXPECT_EQ(groups_of(strip(2, [](const double x) { return x > 5 ? 0.049 * (x - 5) : 0; })).size(), 1u); // 2.8 degrees
  EXPECT_EQ(groups_of(strip(2, [](const double x) { return x > 5 ? 0.051 * (x - 5) : 0; })).size(), 2u); // too high
  const auto lean = [](const double slope) { // short triangles, whose corners stay near the plane
    return std::vector<Corners>{{Vec3(0, 0, 0), Vec3(pixel, 0, 0), Vec3(0, pixel, 0)},
                                {Vec3(0, 0, 0), Vec3(0, -pixel, 0), Vec3(pixel, 0, pixel * slope)}};
  };
  EXPECT_EQ(groups_of(lean(0.041)).size(), 1u); // 3.3 degrees about x and y
  EXPECT_EQ(groups_of(lean(0.06)).size(), 2u);
  EXPECT_EQ(groups_of(strip(2, [](const double x) { return x < 7 ? 0 : 5; })).size(), 2u);
  EXPECT_GT(groups_of(strip(60, [](double) { return 0.0; })).size(), 2u); // 300 pixels
}

TEST(FlatGroups, HoldEachTriangleOnceWithinTheirBounds) {
  std::vector<Corners> triangles;
  for (const Vec3& p : points_inside(300, 7, 0.02)) {
    triangles.push_back({p, p + Vec3(0.004, 0, 0.3 * p[0]), p + Vec3(0, 0.004, 0.3 * p[1])});
    triangles.push_back({p, p, p}); // without an area
  }
  std::vector<int> count(triangles.size(), 0);
  for (const FlatGroup& group : groups_of(triangles)) {
    const auto& [a, b, c] = triangles[group.front()];
    const Vec3 area = (b - a).cross(c - a);
    EXPECT_TRUE(area.norm() > 0 || group.size() == 1);
    for (const std::size_t t : group) {
      ++count[t];
      for (const Vec3& corner : triangles[t])
        EXPECT_LE(std::abs(area.dot(corner - a)), 0.2500001 * pixel * area.norm());
    }
  }
  EXPECT_EQ(std::count(count.begin(), count.end(), 1), static_cast<long>(count.size()));
}

} // namespace
} // namespace kerf::texture::flat_test
