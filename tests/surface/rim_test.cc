/// Where cuts meet the skin: lines and fans in closed form; and that the skin of whole bodies stays where it is.

#include "surface/rim.h"

#include "geometry/triangle.h"
#include "tests/support/placed.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <limits>
#include <map>

namespace kerf::surface {
namespace {

using support::Body;
using support::Random;
using support::random_direction;
using support::random_offset;
using support::random_vector;

double height(const Plane& plane, const Vec3& p) { return plane.normal.dot(p - plane.point); }

double distance_to_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const double t = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (p - a - t * (b - a)).norm();
}

TEST(Rim, MeetsEitherPartOfALine) {
  const Vec3 first(0, 0, 0), corner(1, 0, 0), second(1, 2, 0);
  const auto in_first = meet_line({{0.25, 7, 0}, Vec3::UnitX()}, first, corner, second);
  EXPECT_TRUE(in_first.is_met);
  EXPECT_EQ(in_first.p, Vec3(0.25, 0, 0));
  EXPECT_EQ(in_first.side_of_corner, 1) << "the corner is on the side of the second end";
  const auto in_second = meet_line({{0, 1.5, 3}, -Vec3::UnitY()}, first, corner, second);
  EXPECT_TRUE(in_second.is_met);
  EXPECT_EQ(in_second.p, Vec3(1, 1.5, 0));
  EXPECT_EQ(in_second.side_of_corner, 0);
}

TEST(Rim, GivesTheNearestPointOfALineThatIsNotMet) {
  const Vec3 first(0, 0, 0), corner(1, 0, 0), second(1, 2, 0);
  const auto near = [&](const Vec3& point, const Vec3& normal) {
    const RimPoint rim = meet_line({point, normal}, first, corner, second);
    EXPECT_FALSE(rim.is_met);
    return rim.p;
  };
  EXPECT_EQ(near({-0.1, 0, 0}, Vec3::UnitX()), first);
  EXPECT_EQ(near({0, 2.1, 0}, Vec3::UnitY()), second);
  EXPECT_EQ(near(Vec3(1.1, -0.1, 0), Vec3(1, -1, 0).normalized()), corner);
}

/// On the plane, on the line, and between the corner and the end on the plane's other side.
TEST(Rim, LiesOnPlaneAndLine) {
  Random random(91);
  int n_met = 0;
  for (int i = 0; i < 2000; ++i) {
    const std::array line = {random_vector(random), random_vector(random), random_vector(random)};
    const Plane plane{0.5 * random_vector(random), random_direction(random)};
    const RimPoint rim = meet_line(plane, line[0], line[1], line[2]);
    std::array<double, 3> heights{};
    for (int k = 0; k < 3; ++k)
      heights[k] = height(plane, line[k]);
    const bool crosses_first = heights[0] * heights[1] < 0, crosses_second = heights[1] * heights[2] < 0;
    EXPECT_EQ(rim.is_met, crosses_first || crosses_second);
    const int end = 2 * (1 - rim.side_of_corner); // the one that the corner is parted from
    if (rim.is_met) {
      EXPECT_NEAR(height(plane, rim.p), 0, 1e-14);
      EXPECT_LT(distance_to_segment(rim.p, line[1], line[end]), 1e-14);
      EXPECT_LT(heights[1] * heights[end], 0);
      ++n_met;
    } else
      for (const Vec3& p : line)
        EXPECT_LE(std::abs(height(plane, rim.p)), std::abs(height(plane, p)));
  }
  EXPECT_GT(n_met, 800);
}

TEST(Rim, PartOfAWayBeforeALine) {
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

TEST(Rim, PartOfAWayBeforeATriangle) {
  const std::array<Vec3, 3> triangle = {Vec3(0, 0, 1), Vec3(3, 0, 1), Vec3(0, 3, 1)};
  EXPECT_DOUBLE_EQ(part_before({1, 1, 0}, {1, 1, 4}, triangle), 0.25);
  EXPECT_DOUBLE_EQ(part_before({1, 1, 0}, {1, 1, 0.5}, triangle), 1);
  EXPECT_DOUBLE_EQ(part_before({1, 1, 0}, {1, 1, -4}, triangle), 1);
  EXPECT_DOUBLE_EQ(part_before({2, 2, 0}, {2, 2, 4}, triangle), 1);
  EXPECT_DOUBLE_EQ(part_before({1, 1, 0}, {2, 1, 0}, triangle), 1) << "along it";
}

/// Four spokes to the middles of the sides of a square [-1, 1]^2, whose centre is lifted.
Vec3 rim_of_tent(const double lift, const Plane& plane, const std::array<Vec3, 2>& rim) {
  const std::vector<Vec3> ends = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}};
  return rim_in_fan(plane, rim[0], rim[1], {0, 0, lift}, ends);
}

TEST(Rim, IsStraightInAFlatFan) {
  const Vec3 p = rim_of_tent(0, {{0.5, 0, 0}, Vec3::UnitX()}, {Vec3{0.5, -1, 0}, {0.5, 1, 0}});
  EXPECT_LT((p - Vec3(0.5, 0, 0)).norm(), 1e-15);
}

TEST(Rim, BendsWhereItCrossesASpoke) {
  const Vec3 on_spoke = rim_of_tent(0.8, {{0.25, 0, 0}, Vec3::UnitX()}, {Vec3{0.25, -1, 0}, {0.25, 1, 0}});
  EXPECT_LT((on_spoke - Vec3(0.25, 0, 0.6)).norm(), 1e-15);
  // Two spokes are crossed: (0.8, 0) at height 0.2 * lift and (0, 0.4) at 0.6 * lift, which is farther from the chord.
  const Vec3 n = Vec3(1, 2, 0).normalized();
  const Vec3 higher = rim_of_tent(0.8, {{0.8, 0, 0}, n}, {Vec3{1, -0.1, 0}, {-0.4, 0.6, 0}});
  EXPECT_LT((higher - Vec3(0, 0.4, 0.48)).norm(), 1e-15);
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

/// From each cell's skin to the skin that it had before [m].
struct Moved {
  double vertices = 0, triangles = 0;
  std::size_t n = 0, n_off = 0; ///< triangles; those that do not lie in the skin
};

Moved moved(const Skin& now, const Skin& before) {
  Moved result;
  for (const auto& [cell, triangles] : now.of_skin)
    for (const auto& triangle : triangles) {
      for (const Vec3& p : triangle)
        result.vertices = std::max(result.vertices, distance({p, p, p}, before.of_skin.at(cell)));
      const double off = distance(triangle, before.of_skin.at(cell));
      result.triangles = std::max(result.triangles, off);
      ++result.n;
      result.n_off += off > 1e-12;
    }
  return result;
}

/// The sum of all triangles' shadows on the coordinate planes [m^2].
Vec3 area(const TrianglesOfCells& all) {
  Vec3 sum = Vec3::Zero();
  for (const auto& [cell, triangles] : all)
    for (const auto& [a, b, c] : triangles)
      sum += 0.5 * (b - a).cross(c - a).cwiseAbs();
  return sum;
}

/// On a flat skin with sharp edges every triangle of the skin lies in the skin that was there, and there is as much
/// of it. Where several cuts cross within a cell at a sharp edge of the box, a few walls between them run across the
/// edge.
TEST(Rim, TheSkinOfABoxStaysWhereItIs) {
  Random random(92);
  const Box box{{0, 0, 0}, {0.73, 0.61, 0.52}};
  Moved by_one, by_more;
  for (int i = 0; i < 40; ++i) {
    Body body = support::embedded(geometry::box_mesh(box.lower, box.upper), 0.1, random_offset(random));
    const Skin before = skin_of(body);
    for (grid::CutLabel label = 1; label <= 3; ++label) {
      const Vec3 normal = random_direction(random);
      const double offset = normal.dot(0.5 * (box.lower + box.upper) + 0.05 * random_vector(random));
      support::cut_through(body, support::plane_cuts(body, {normal, offset}, label));
      const Skin now = skin_of(body);
      const Moved step = moved(now, before);
      Moved& all = label == 1 ? by_one : by_more;
      all.vertices = std::max(all.vertices, step.vertices);
      all.triangles = std::max(all.triangles, step.triangles);
      all.n += step.n;
      all.n_off += step.n_off;
      EXPECT_TRUE(label > 1 || (area(now.of_skin) - area(before.of_skin)).norm() < 1e-12);
    }
  }
  std::cout << "one cut: the skin moves by " << by_one.triangles << " m; more cuts: vertices by " << by_more.vertices
            << " m, " << by_more.n_off << " of " << by_more.n << " triangles across an edge, by at most "
            << by_more.triangles / 0.1 << " h\n";
  EXPECT_LT(by_one.triangles, 1e-12);
  EXPECT_LT(by_more.vertices, 1e-12);
  EXPECT_LT(static_cast<double>(by_more.n_off), 1e-3 * static_cast<double>(by_more.n));
}

/// On a curved skin a rim keeps its cell's volume, at the price of a move along the cut: of second order in h.
TEST(Rim, TheSkinOfABallMovesToSecondOrder) {
  constexpr double radius = 0.41;
  std::vector<double> worsts;
  for (const double h : {0.1, 0.05, 0.025}) {
    Random random(93);
    double worst = 0;
    for (int i = 0; i < 6; ++i) {
      Body body = support::embedded(geometry::sphere_mesh(radius, Vec3::Zero(), 5), h, random_offset(random));
      const Skin before = skin_of(body);
      const Vec3 normal = random_direction(random);
      support::cut_through(body, support::plane_cuts(body, {normal, 0.1 * normal.dot(random_vector(random))}));
      worst = std::max(worst, moved(skin_of(body), before).triangles);
    }
    worsts.push_back(worst);
    std::cout << "h " << h << " m: the skin moves by at most " << worst / h << " h, " << worst / (h * h / radius)
              << " h^2 / R\n";
    EXPECT_LT(worst, 0.1 * h * h / radius);
  }
  EXPECT_GT(0.5 * std::log2(worsts.front() / worsts.back()), 1.7);
}

/// The cut of a plane lies in the plane, walls included; but for walls to a sharp edge of the skin, in cells where no
/// vertex on the rim would keep the volume.
TEST(Rim, CutsLieInTheirPlane) {
  Random random(94);
  const Box box{{0, 0, 0}, {0.73, 0.61, 0.52}};
  std::size_t n = 0, n_off = 0;
  double worst = 0;
  for (int i = 0; i < 60; ++i) {
    Body body = support::embedded(geometry::box_mesh(box.lower, box.upper), 0.1, random_offset(random));
    const Vec3 normal = random_direction(random);
    const double offset = normal.dot(0.5 * (box.lower + box.upper) + 0.05 * random_vector(random));
    support::cut_through(body, support::plane_cuts(body, {normal, offset}));
    for (const auto& [cell, triangles] : skin_of(body).of_cuts)
      for (const auto& triangle : triangles) {
        double off = 0;
        for (const Vec3& p : triangle)
          off = std::max(off, std::abs(normal.dot(p) - offset));
        ++n;
        n_off += off > 1e-12;
        worst = std::max(worst, off);
      }
  }
  std::cout << n_off << " of " << n << " triangles of cuts off their plane, by at most " << worst / 0.1 << " h\n";
  EXPECT_GT(n, 30000u);
  EXPECT_LT(static_cast<double>(n_off), 5e-3 * static_cast<double>(n));
  EXPECT_LT(worst, 0.1);
}

} // namespace
} // namespace kerf::surface
