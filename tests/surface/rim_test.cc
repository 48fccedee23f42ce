/// Where cuts meet the skin: the skin of whole bodies stays where it is, and the cuts end on it.

#include "surface/below_skin.h"

#include "geometry/triangle.h"
#include "tests/support/placed.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <limits>
#include <map>
#include <numbers>

namespace kerf::surface::rim_test {
namespace {

using support::Body;
using support::Random;
using support::random_direction;
using support::random_offset;
using support::random_vector;

TEST(BelowSkin, PartOfAWayBeforeALine) {
  const Vec3 first(1, -1, 0), corner(1, 1, 0), second(-1, 1, 0); // in the plane z = 0
  EXPECT_DOUBLE_EQ(part_before_line({0, 0, 0}, {2, 0, 0}, first, corner, second, 2), 0.5);
  EXPECT_DOUBLE_EQ(part_before_line({0, 0, 0}, {0, 4, 0}, first, corner, second, 2), 0.25);
  EXPECT_DOUBLE_EQ(part_before_line({0, 0, 0}, {-2, 0, 0}, first, corner, second, 2), 1) << "the other way";
  EXPECT_DOUBLE_EQ(part_before_line({0, 0, 0}, {0.5, 0, 0}, first, corner, second, 2), 1) << "not so far";
  EXPECT_DOUBLE_EQ(part_before_line({0, 0, 0}, {4, -8, 0}, first, corner, second, 2), 1) << "beside its end";
  EXPECT_DOUBLE_EQ(part_before_line({0, 0, 0}, {-4, 2, 0}, first, corner, second, 2), 1) << "beside its other end";
  for (int axis = 0; axis < 3; ++axis) { // the same in the faces of each axis
    const auto turned = [axis](const Vec3& p) {
      Vec3 q;
      for (int i = 0; i < 3; ++i)
        q[(i + axis + 1) % 3] = p[i];
      return q;
    };
    EXPECT_DOUBLE_EQ(
      part_before_line(turned({0, 0, 0}), turned({2, 0.5, 0}), turned(first), turned(corner), turned(second), axis),
      0.5);
  }
}

TEST(BelowSkin, PartOfAWayBeforeATriangle) {
  const std::array<Vec3, 3> triangle = {Vec3(0, 0, 1), Vec3(3, 0, 1), Vec3(0, 3, 1)};
  EXPECT_DOUBLE_EQ(part_before({1, 1, 0}, {1, 1, 4}, triangle), 0.25);
  EXPECT_DOUBLE_EQ(part_before({1, 1, 0}, {1, 1, 0.5}, triangle), 1);
  EXPECT_DOUBLE_EQ(part_before({1, 1, 0}, {1, 1, -4}, triangle), 1);
  EXPECT_DOUBLE_EQ(part_before({2, 2, 0}, {2, 2, 4}, triangle), 1);
  EXPECT_DOUBLE_EQ(part_before({1, 1, 0}, {2, 1, 0}, triangle), 1) << "along it";
}

using TrianglesOfCells = std::map<std::uint32_t, std::vector<std::array<Vec3, 3>>>;

struct Skin {
  TrianglesOfCells of_skin, of_cuts;
};

Skin skin_of(const Body& cut) {
  const Body body = support::with_copies(cut);
  const Surface s = build_surface(body);
  Skin skin;
  for (std::size_t t = 0; t < s.triangles.size(); ++t) {
    const auto& [a, b, c] = s.triangles[t];
    auto& triangles = s.labels[t] == grid::skin_label ? skin.of_skin : skin.of_cuts;
    triangles[body.complex.copies[s.copies[t]].cell.value].push_back({s.rest[a], s.rest[b], s.rest[c]});
  }
  return skin;
}

/// How far from triangles a triangle's corners, the middles of its sides and its centre lie at most [m].
double distance(const std::array<Vec3, 3>& triangle, const std::vector<std::array<Vec3, 3>>& others) {
  const auto& [a, b, c] = triangle;
  double worst = 0;
  for (const Vec3& p :
       {a, b, c, Vec3(0.5 * (a + b)), Vec3(0.5 * (b + c)), Vec3(0.5 * (c + a)), Vec3((a + b + c) / 3)}) {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& other : others)
      least = std::min(least, (geometry::closest_point(p, other) - p).norm());
    worst = std::max(worst, least);
  }
  return worst;
}

/// The largest distance from each cell's skin to the skin that it had before [m].
double moved(const Skin& now, const Skin& before) {
  double worst = 0;
  for (const auto& [cell, triangles] : now.of_skin)
    for (const auto& triangle : triangles)
      worst = std::max(worst, distance(triangle, before.of_skin.at(cell)));
  return worst;
}

/// The sum of all triangles' shadows on the coordinate planes [m^2].
Vec3 area(const TrianglesOfCells& all) {
  Vec3 sum = Vec3::Zero();
  for (const auto& [cell, triangles] : all)
    for (const auto& [a, b, c] : triangles)
      sum += 0.5 * (b - a).cross(c - a).cwiseAbs();
  return sum;
}

const Box box{{0, 0, 0}, {0.73, 0.61, 0.52}};

/// Flat with sharp edges, curved, and a liver.
std::vector<Body> bodies(Random& random) {
  return {support::embedded(geometry::box_mesh(box.lower, box.upper), 0.1, random_offset(random)),
          support::embedded(geometry::sphere_mesh(0.41, Vec3::Zero(), 4), 0.1, random_offset(random)),
          support::embedded(support::liver_mesh(), 0.016, random_offset(random))};
}

/// Some point of it.
Vec3 point_in(Random& random, const Body& body) {
  return body.grid.position(grid::NodeId(random() % body.grid.n_nodes())) + 0.3 * body.grid.h() * random_vector(random);
}

/// Every triangle of the skin lies in the skin that was there, and there is as much of it: after one cut and after
/// three.
TEST(Rim, TheSkinStaysWhereItIs) {
  Random random(92);
  double worst = 0;
  for (int i = 0; i < 15; ++i)
    for (Body& body : bodies(random)) {
      const Skin before = skin_of(body);
      for (grid::CutLabel label = 1; label <= 3; ++label) {
        const Vec3 normal = random_direction(random);
        support::cut_through(body, support::cuts_of_plane(body, {normal, normal.dot(point_in(random, body))}, label));
        const Skin now = skin_of(body);
        worst = std::max(worst, moved(now, before) / body.grid.h());
        EXPECT_LT((area(now.of_skin) - area(before.of_skin)).norm(), 1e-12 * area(before.of_skin).norm());
      }
    }
  EXPECT_LT(worst, 1e-12);
}

/// All vertices of a plane's cut lie in the plane, and those at the skin, its rim, on the skin.
TEST(Rim, CutsLieInTheirPlane) {
  Random random(94);
  std::size_t n = 0;
  double worst = 0;
  for (int i = 0; i < 20; ++i)
    for (Body& body : bodies(random)) {
      const Vec3 normal = random_direction(random);
      const double offset = normal.dot(point_in(random, body));
      support::cut_through(body, support::cuts_of_plane(body, {normal, offset}));
      for (const auto& [cell, triangles] : skin_of(body).of_cuts)
        for (const auto& triangle : triangles)
          for (const Vec3& p : triangle) {
            worst = std::max(worst, std::abs(normal.dot(p) - offset) / body.grid.h());
            ++n;
          }
    }
  EXPECT_GT(n, 30000u);
  EXPECT_LT(worst, 1e-11);
}

struct Quality {
  std::size_t n = 0, n_needles = 0, n_flat = 0;
  double longest = 0; ///< [h]
};

/// Of triangles that have a vertex on the rim.
Quality quality_of_cuts(const Body& cut) {
  const Body body = support::with_copies(cut);
  const Surface s = build_surface(body);
  Quality quality;
  for (std::size_t t = 0; t < s.triangles.size(); ++t) {
    if (s.labels[t] == grid::skin_label)
      continue;
    const auto& [a, b, c] = s.triangles[t];
    const std::array<Vec3, 3> sides = {s.rest[b] - s.rest[a], s.rest[c] - s.rest[b], s.rest[a] - s.rest[c]};
    double least = 4;
    for (int i = 0; i < 3; ++i) {
      const Vec3 u = sides[i], v = -sides[(i + 2) % 3];
      least = std::min(least, std::atan2(u.cross(v).norm(), u.dot(v)));
      quality.longest = std::max(quality.longest, u.norm() / body.grid.h());
    }
    ++quality.n;
    quality.n_needles += least < std::numbers::pi / 180;
    quality.n_flat += !(sides[0].cross(sides[1]).norm() > 0);
  }
  return quality;
}

TEST(Rim, TrianglesOfCutsAreShortAndHaveArea) {
  Random random(95);
  Quality all;
  for (int i = 0; i < 20; ++i)
    for (Body& body : bodies(random)) {
      const Vec3 normal = random_direction(random);
      support::cut_through(body, support::cuts_of_plane(body, {normal, normal.dot(point_in(random, body))}));
      const Quality of_body = quality_of_cuts(body);
      all = {all.n + of_body.n, all.n_needles + of_body.n_needles, all.n_flat + of_body.n_flat,
             std::max(all.longest, of_body.longest)};
    }
  std::cout << all.n << " triangles, " << all.n_needles << " needles (below 1 degree), the longest side " << all.longest
            << " h\n";
  EXPECT_EQ(all.n_flat, 0u);
  EXPECT_LT(all.longest, 2);
}

} // namespace
} // namespace kerf::surface::rim_test
