/// The cases of thesis figure 2.15, each against its formula, and what holds for every set of cuts.

#include "surface/placement.h"

#include "grid/cube.h"
#include "tests/support/placed.h"

#include <gtest/gtest.h>

#include <iostream>
#include <numbers>

namespace kerf::surface {
namespace {

using grid::CellId;
using grid::EdgeCut;
using grid::EdgeId;
using grid::FaceId;
using support::Body;
using support::Random;
using support::uniform;

/// The middle of a block: a cell with material all around, its lowest node at (2, 2, 2).
class Inside : public testing::Test {
 protected:
  Body body = support::block({4, 4, 4});
  CellId cell = *body.grid.find_cell({2, 2, 2});

  EdgeId edge(const int i, const int j, const int k, const int axis) const {
    return *body.grid.find_edge({i, j, k}, axis);
  }
  /// The face at z = 2.
  FaceId face() const { return body.grid.faces(cell)[4]; }
  Vec3 face_point() const { return grid::face_point(body.grid, body.cuts, face()); }
  Vec3 cell_point() const { return grid::cell_point(body.grid, body.cuts, cell); }
  PlacementCounts cut(const std::vector<EdgeCut>& cuts) { return support::cut(body, cuts); }
};

void expect_near(const Vec3& a, const Vec3& b, const double tolerance = 1e-14) {
  EXPECT_LE((a - b).norm(), tolerance) << a.transpose() << " is not " << b.transpose();
}

TEST_F(Inside, OneCutProjectsTheCentres) {
  const Vec3 normal = Vec3(3, 1, -0.5).normalized(), p(2.4, 2, 2);
  const auto counts = cut({{edge(2, 2, 2, 0), 0.4, normal, 1}});
  EXPECT_EQ(counts.n_placed, 8u) << "four faces and four cells around an edge";
  EXPECT_EQ(counts.n_clamped, 0u);
  const Vec3 in_face = Vec3(normal[0], normal[1], 0).normalized(), face_centre(2.5, 2.5, 2);
  const double lean = normal.head<2>().norm();
  expect_near(face_point(), face_centre - normal.dot(face_centre - p) / lean * in_face);
  const Vec3 centre = Vec3::Constant(2.5);
  expect_near(cell_point(), centre - normal.dot(centre - p) * normal);
  for (const int untouched : {0, 1, 3, 5})
    EXPECT_EQ(body.cuts.point(body.grid.faces(cell)[untouched]), nullptr);
}

TEST_F(Inside, ASmoothCutTakesTheMiddleOfTheBezierCurve) {
  // A circle around (0, 2.5): the face's lines y = 2 and y = 3 cut it. Tangents meet at the pole of the chord.
  for (const double radius : {1.5, 2.4, 10.0}) {
    body = support::block({4, 4, 4});
    const double x = 2.4, half_chord = 0.5, to_chord = std::sqrt(radius * radius - half_chord * half_chord);
    const Vec3 middle(x - to_chord, 2.5, 2);
    const auto normal = [&](const double y) { return Vec3(to_chord, y - 2.5, 0).normalized(); };
    cut({{edge(2, 2, 2, 0), x - 2, normal(2), 1}, {edge(2, 3, 2, 0), x - 2, normal(3), 1}});
    const Vec3 pole(middle[0] + radius * radius / to_chord, 2.5, 2);
    const Vec3 a(x, 2, 2), b(x, 3, 2);
    expect_near(face_point(), 0.25 * a + 0.5 * pole + 0.25 * b);
  }
}

TEST_F(Inside, TheNormalsSignHasNoMeaning) {
  const Vec3 a = Vec3(1, 0.2, 0).normalized(), b = Vec3(1, -0.1, 0).normalized();
  cut({{edge(2, 2, 2, 0), 0.4, a, 1}, {edge(2, 3, 2, 0), 0.45, b, 1}});
  const Vec3 with = face_point();
  body = support::block({4, 4, 4});
  cut({{edge(2, 2, 2, 0), 0.4, -a, 1}, {edge(2, 3, 2, 0), 0.45, b, 1}});
  expect_near(with, face_point());
}

TEST_F(Inside, ASharpCutTakesTheIntersection) {
  cut({{edge(2, 2, 2, 0), 0.3, Vec3::UnitX(), 1}, {edge(2, 2, 2, 1), 0.6, Vec3::UnitY(), 1}});
  expect_near(face_point(), {2.3, 2.6, 2});
}

TEST_F(Inside, TheSharpAngleDecides) {
  // Two planes that turn by 40 degrees.
  const double lean = 20 * std::numbers::pi / 180;
  const std::vector<EdgeCut> cuts = {{edge(2, 2, 2, 0), 0.4, Vec3(std::cos(lean), std::sin(lean), 0), 1},
                                     {edge(2, 3, 2, 0), 0.4, Vec3(std::cos(lean), -std::sin(lean), 0), 1}};
  for (const auto& c : cuts)
    body.cuts.add(c);
  // The planes' intersection: from (2.4, 2) along (-sin, cos) to y = 2.5.
  const Vec3 meeting(2.4 - 0.5 * std::tan(lean), 2.5, 2);
  const std::vector<EdgeId> edges = {cuts[0].edge, cuts[1].edge};
  place(body.grid, body.cuts, edges, {.sharp_angle = 45});
  expect_near(face_point(), 0.5 * meeting + 0.5 * Vec3(2.4, 2.5, 2));
  place(body.grid, body.cuts, edges, {.sharp_angle = 35});
  expect_near(face_point(), meeting);
}

TEST_F(Inside, APlaneIsMetExactly) {
  Random random(11);
  for (int i = 0; i < 200; ++i) {
    body = support::block({4, 4, 4});
    const Vec3 normal = support::random_direction(random);
    const support::Plane plane{normal, normal.dot(Vec3(2.5, 2.5, 2.5) + 0.3 * support::random_vector(random))};
    auto cuts = support::plane_cuts(body, plane);
    for (auto& c : cuts)
      if (i % 2)
        c.normal *= uniform(random, -1, 1) < 0 ? -1 : 1;
    cut(cuts);
    for (const auto& c : cuts)
      for (const CellId around : body.grid.cells(c.edge))
        if (around.valid() && !support::is_skin_cell(body.grid, around)) {
          EXPECT_NEAR(plane.height(grid::cell_point(body.grid, body.cuts, around)), 0, 1e-14);
          for (const FaceId f : body.grid.faces(around))
            if (body.cuts.point(f)) {
              EXPECT_NEAR(plane.height(grid::face_point(body.grid, body.cuts, f)), 0, 1e-14);
            }
        }
  }
}

TEST_F(Inside, LaterCutsOfASplitFaceStayOnBothPlanes) {
  cut({{edge(2, 2, 2, 0), 0.3, Vec3::UnitX(), 1}, {edge(2, 3, 2, 0), 0.3, Vec3::UnitX(), 1}});
  expect_near(face_point(), {2.3, 2.5, 2});
  cut({{edge(2, 2, 2, 1), 0.8, Vec3::UnitY(), 2}}); // figure 2.15 (d)
  expect_near(face_point(), {2.3, 2.8, 2});
  cut({{edge(3, 2, 2, 1), 0.8, Vec3::UnitY(), 2}}); // (e)
  expect_near(face_point(), {2.3, 2.8, 2});
}

TEST_F(Inside, LaterCutsOfASplitCellStayOnAllPlanes) {
  const auto across = [&](const int axis, const double t, const grid::CutLabel label) {
    std::vector<EdgeCut> cuts;
    for (const EdgeId e : body.grid.edges(cell))
      if (body.grid.axis(e) == axis)
        cuts.push_back({e, t, Vec3::Unit(axis), label});
    return cuts;
  };
  cut(across(0, 0.3, 1));
  expect_near(cell_point(), {2.3, 2.5, 2.5});
  cut(across(1, 0.8, 2));
  expect_near(cell_point(), {2.3, 2.8, 2.5});
  cut(across(2, 0.1, 3));
  expect_near(cell_point(), {2.3, 2.8, 2.1});
}

TEST_F(Inside, ATiltedSecondPlaneIsMetAlongTheFirst) {
  Random random(12);
  for (int i = 0; i < 100; ++i) {
    body = support::block({4, 4, 4});
    std::vector<EdgeCut> first;
    for (const EdgeId e : body.grid.edges(cell))
      if (body.grid.axis(e) == 0)
        first.push_back({e, 0.6, Vec3::UnitX(), 1});
    cut(first);
    const Vec3 normal = Vec3(uniform(random, -0.5, 0.5), 1, uniform(random, -0.5, 0.5)).normalized();
    const support::Plane plane{normal, normal.dot(Vec3(2.6, uniform(random, 2.3, 2.7), 2.5))};
    cut(support::plane_cuts(body, plane, 2));
    EXPECT_NEAR(cell_point()[0], 2.6, 1e-14);
    EXPECT_NEAR(plane.height(cell_point()), 0, 1e-14);
    expect_near(cell_point().cwiseMax(2).cwiseMin(3), cell_point(), 0);
  }
}

TEST_F(Inside, WhatWouldLeaveIsHeldAndCounted) {
  // From (2.5, 2.5) the nearest point of this plane has x < 2; across y = 2 it does not.
  const double lean = std::numbers::pi / 6;
  const auto counts = cut({{edge(2, 2, 2, 0), 0.05, Vec3(std::cos(lean), std::sin(lean), 0), 1}});
  EXPECT_EQ(counts.n_placed, 8u);
  EXPECT_EQ(counts.n_clamped, 3u) << "one face and the two cells beside it";
  EXPECT_NEAR(face_point()[0], 2 + grid::min_edge_parameter, 1e-14);
  EXPECT_NEAR(cell_point()[0], 2 + grid::min_edge_parameter, 1e-14);
}

/// No vertex leaves its face or cell, with room for the octants.
void expect_all_inside(const Body& body) {
  const double h = body.grid.h(), margin = 0.25 * grid::min_edge_parameter * h;
  for (const auto c : ids<CellId>(body.grid.n_cells())) {
    const Vec3 lower = body.grid.origin(c) + Vec3::Constant(margin);
    const Vec3 upper = body.grid.origin(c) + Vec3::Constant(h - margin);
    ASSERT_TRUE((Box{lower, upper}.contains(grid::cell_point(body.grid, body.cuts, c))));
    for (int face = 0; face < 6; ++face) {
      Vec3 p = grid::face_point(body.grid, body.cuts, body.grid.faces(c)[face]);
      const int axis = face / 2;
      ASSERT_NEAR(p[axis], body.grid.origin(c)[axis] + (face & 1 ? h : 0), 1e-14 * (1 + std::abs(p[axis])));
      p[axis] = lower[axis];
      ASSERT_TRUE((Box{lower, upper}.contains(p)));
    }
  }
}

TEST(Placement, NothingLeavesItsFaceOrCell) {
  Random random(13);
  const Body sphere = support::embedded(geometry::sphere_mesh(1, Vec3::Zero(), 3), 0.21, {0.2, 0.4, 0.9});
  const Body block = support::block({4, 3, 4}, 0.1);
  const Body liver = support::embedded(support::liver_mesh(), 0.02, {0.5, 0.3, 0.1});
  for (int i = 0; i < 60; ++i) {
    Body body = i % 10 == 0 ? liver : i % 2 ? sphere : block;
    for (grid::CutLabel label = 1; label <= 4; ++label) {
      support::cut(body, support::random_cuts(random, body, uniform(random, 0, 0.5), label));
      expect_all_inside(body);
      ASSERT_FALSE(testing::Test::HasFatalFailure()) << "body " << i;
    }
  }
}

/// The largest distance of a skin triangle from the planes of the box [m]: all three vertices lie on one of them.
double worst_skin_distance(const Surface& surface, const Box& box) {
  double worst = 0;
  for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
    if (surface.labels[i] != grid::skin_label)
      continue;
    double nearest = 1e300;
    for (int axis = 0; axis < 3; ++axis)
      for (const double side : {box.lower[axis], box.upper[axis]}) {
        double farthest = 0;
        for (const auto v : surface.triangles[i])
          farthest = std::max(farthest, std::abs(surface.rest[v][axis] - side));
        nearest = std::min(nearest, farthest);
      }
    worst = std::max(worst, nearest);
  }
  return worst;
}

TEST(Placement, APlaneSkinStaysPlaneUnderArbitraryCuts) {
  Random random(14);
  const Box box{{0, 0, 0}, {0.73, 0.61, 0.52}};
  double worst = 0, worst_volume = 0;
  for (int i = 0; i < 40; ++i) {
    const Vec3 offset(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1));
    Body body = support::embedded(geometry::box_mesh(box.lower, box.upper), 0.1, offset);
    for (grid::CutLabel label = 1; label <= 3; ++label) {
      support::cut(body, support::random_cuts(random, body, uniform(random, 0, 0.4), label));
      const auto s = build_surface(body.grid, body.cuts, grid::build_complex(body.grid, body.cuts));
      worst = std::max(worst, worst_skin_distance(s, box));
      worst_volume = std::max(worst_volume, std::abs(enclosed_volume(s.rest, s.triangles) / 0.231556 - 1));
    }
  }
  std::cout << "skin off its plane by at most " << worst << " m, volume off by at most " << worst_volume << '\n';
  EXPECT_LT(worst, 1e-14);
  EXPECT_LT(worst_volume, 1e-12);
}

} // namespace
} // namespace kerf::surface
