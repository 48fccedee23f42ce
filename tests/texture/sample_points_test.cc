#include "texture/sample_points.h"
#include "tests/texture/probes.h"

#include <gtest/gtest.h>

#include <numeric>
#include <set>

namespace kerf::texture::sample_points_test {
namespace {

/// A square of n x n squares, each in two triangles, on a curved surface; corners of each start elsewhere.
std::vector<Corners> sheet(const int n) {
  std::vector<Corners> triangles;
  const auto at = [](const int x, const int y) {
    return Vec3(0.013 * x + 0.001 * y, 0.011 * y, 0.002 * std::sin(1.7 * x + y));
  };
  for (int x = 0; x < n; ++x)
    for (int y = 0; y < n; ++y) {
      triangles.push_back({at(x, y), at(x + 1, y), at(x, y + 1)});
      triangles.push_back({at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)});
    }
  for (std::size_t t = 0; t < triangles.size(); ++t)
    std::rotate(triangles[t].begin(), triangles[t].begin() + t % 3, triangles[t].end());
  return triangles;
}

std::vector<std::size_t> numbers_to(const std::size_t n) {
  std::vector<std::size_t> numbers(n);
  std::iota(numbers.begin(), numbers.end(), 0);
  return numbers;
}

using Place = std::array<double, 3>;
Place place_of(const Vec3& p) { return {p[0], p[1], p[2]}; }

TEST(SamplePoints, LieWhereTheirSamplesDo) {
  const std::vector<Corners> triangles = sheet(4);
  std::vector<std::uint16_t> parts;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    parts.push_back(static_cast<std::uint16_t>(1 + t % 7)); // neighbours with as many parts as each other, and not
  SamplePoints points;
  points.collect(numbers_to(triangles.size()), triangles, parts);
  const std::uint32_t* number = points.numbers().data();
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const auto& [a, b, c] = triangles[t];
    for_each_sample(parts[t], [&](const int i, const int j) {
      const Vec3 p = a + double(i) / parts[t] * (b - a) + double(j) / parts[t] * (c - a);
      EXPECT_LT((points.places()[*number++] - p).norm(), 1e-17);
    });
  }
  EXPECT_EQ(number, points.numbers().data() + points.numbers().size());
}

TEST(SamplePoints, AreOneWhereTrianglesMeet) {
  constexpr int n = 5, n_parts = 6;
  const std::vector<Corners> triangles = sheet(n);
  const std::vector<std::uint16_t> parts(triangles.size(), n_parts);
  SamplePoints points;
  points.collect(numbers_to(triangles.size()), triangles, parts);
  EXPECT_EQ(points.numbers().size(), 2 * n * n * n_samples(n_parts));
  EXPECT_EQ(points.places().size(), (n * n_parts + 1) * (n * n_parts + 1)); // those of one lattice
}

/// So what a place shows does not depend on which of its triangles is painted first, or with which others.
TEST(SamplePoints, HaveTheSameBitsInAnyOrder) {
  std::vector<Corners> triangles = sheet(4);
  const std::vector<std::uint16_t> parts(triangles.size(), 5);
  const auto sides_in_order = [&](const std::vector<std::size_t>& order) {
    SamplePoints points;
    points.collect(order, triangles, parts);
    std::vector<std::set<Place>> places(triangles.size());
    const std::uint32_t* number = points.numbers().data();
    for (const std::size_t t : order)
      for_each_sample(parts[t], [&](const int i, const int j) {
        if (i == 0 || j == 0 || i + j == parts[t])
          places[t].insert(place_of(points.places()[*number]));
        ++number;
      });
    return places;
  };
  std::vector<std::size_t> order = numbers_to(triangles.size());
  const auto forth = sides_in_order(order);
  std::reverse(order.begin(), order.end());
  for (Corners& corners : triangles)
    std::rotate(corners.begin(), corners.begin() + 1, corners.end());
  EXPECT_EQ(sides_in_order(order), forth);
  for (std::size_t t = 0; t < triangles.size(); ++t)
    EXPECT_EQ(sides_in_order({t})[t], forth[t]);
}

} // namespace
} // namespace kerf::texture::sample_points_test
