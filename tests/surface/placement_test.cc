/// The cases of thesis figure 2.15, each against its formula, and what holds for every set of cuts.

#include "surface/placement.h"

#include "grid/cube.h"
#include "tests/support/placed.h"

#include <gtest/gtest.h>

#include <iostream>
#include <numbers>

namespace kerf::surface::placement_test {
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
  Body body = support::with_placed_skin(support::block({4, 4, 4}));
  CellId cell = *body.grid.find_cell({2, 2, 2});

  EdgeId edge(const int i, const int j, const int k, const int axis) const {
    return *body.grid.find_edge({i, j, k}, axis);
  }
  /// The face at z = 2.
  FaceId face() const { return body.grid.faces(cell)[4]; }
  Vec3 face_point() const { return grid::face_point(body, face()); }
  Vec3 cell_point() const { return grid::cell_point(body, cell); }
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
    body = support::with_placed_skin(support::block({4, 4, 4}));
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
  body = support::with_placed_skin(support::block({4, 4, 4}));
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
    body.cuts.add(body.grid, c);
  // The planes' intersection: from (2.4, 2) along (-sin, cos) to y = 2.5.
  const Vec3 meeting(2.4 - 0.5 * std::tan(lean), 2.5, 2);
  const grid::Cuts unplaced = body.cuts;
  place(body, {.sharp_angle = 45});
  expect_near(face_point(), 0.5 * meeting + 0.5 * Vec3(2.4, 2.5, 2));
  body.cuts = unplaced;
  place(body, {.sharp_angle = 35});
  expect_near(face_point(), meeting);
}

TEST_F(Inside, APlaneIsMetExactly) {
  Random random(11);
  for (int i = 0; i < 200; ++i) {
    body = support::with_placed_skin(support::block({4, 4, 4}));
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
          EXPECT_NEAR(plane.height(grid::cell_point(body, around)), 0, 1e-14);
          for (const FaceId f : body.grid.faces(around))
            if (body.cuts.point(f)) {
              EXPECT_NEAR(plane.height(grid::face_point(body, f)), 0, 1e-14);
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
    body = support::with_placed_skin(support::block({4, 4, 4}));
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

/// Thesis figure 2.15: one face, cut line by line.
using Figure215 = Inside;

TEST_F(Figure215, A_AFrontEndsWhereTheCentreMeetsThePlane) {
  cut({{edge(2, 2, 2, 0), 0.4, Vec3(0.8, 0.6, 0), 1}});
  // From the centre (2.5, 2.5) by 0.8 * 0.1 + 0.6 * 0.5 = 0.38 against the normal.
  expect_near(face_point(), {2.5 - 0.38 * 0.8, 2.5 - 0.38 * 0.6, 2});
  EXPECT_EQ(grid::n_pieces(grid::build_complex(body)), 1u);
}

TEST_F(Figure215, B_ASmoothCutTakesTheMiddleOfTheBezierCurve) {
  // Planes of slope -1/4 and 1/4 through (2.4, 2) and (2.4, 3) meet at (2.275, 2.5).
  cut(
    {{edge(2, 2, 2, 0), 0.4, Vec3(4, 1, 0).normalized(), 1}, {edge(2, 3, 2, 0), 0.4, Vec3(4, -1, 0).normalized(), 1}});
  expect_near(face_point(), {0.25 * 2.4 + 0.5 * 2.275 + 0.25 * 2.4, 2.5, 2});
}

TEST_F(Figure215, C_ASharpCutTakesTheIntersection) {
  // Lines that turn by 90 degrees: x + y = 4.75 through (2.75, 2), y - x = 0.25 through (2.75, 3).
  cut({{edge(2, 2, 2, 0), 0.75, Vec3(1, 1, 0).normalized(), 1},
       {edge(2, 3, 2, 0), 0.75, Vec3(1, -1, 0).normalized(), 1}});
  expect_near(face_point(), {2.25, 2.5, 2});
}

TEST_F(Figure215, D_ALaterCutProjectsOntoItsPlane) {
  cut({{edge(2, 2, 2, 0), 0.4, Vec3::UnitX(), 1}, {edge(2, 3, 2, 0), 0.4, Vec3::UnitX(), 1}});
  const Vec3 before = face_point(), q(3, 2.7, 2);
  expect_near(before, {2.4, 2.5, 2});
  cut({{edge(3, 2, 2, 1), 0.7, Vec3::UnitY(), 2}});
  expect_near(face_point(), before - Vec3::UnitY() * Vec3::UnitY().dot(before - q)); // the plain projection
}

TEST_F(Figure215, D_ALaterCutAtAnAngleProjectsWithinTheEarlierPlane) {
  const Vec3 normal = Vec3(0.5, 1, 0).normalized();
  cut({{edge(2, 2, 2, 0), 0.4, Vec3::UnitX(), 1}, {edge(2, 3, 2, 0), 0.4, Vec3::UnitX(), 1}});
  cut({{edge(3, 2, 2, 1), 0.3, normal, 2}});
  // 0.5 (x - 3) + (y - 2.3) = 0 at x = 2.4; plainly projected, the vertex would leave the first cut by 0.04.
  expect_near(face_point(), {2.4, 2.6, 2});
}

TEST_F(Figure215, E_ACrossCutTakesTheIntersectionInEitherOrder) {
  const Vec3 m = Vec3(1, 0.3, 0).normalized(), n = Vec3(-0.2, 1, 0).normalized();
  const auto at = [](const Vec3& normal, const Vec3& p, const int axis) { // parameter of the edge of p along the axis
    return normal.dot(Vec3(2.5, 2.5, 2) - p) / normal[axis];
  };
  const std::vector<EdgeCut> across = {{edge(2, 2, 2, 0), at(m, {2, 2, 2}, 0), m, 1},
                                       {edge(2, 3, 2, 0), at(m, {2, 3, 2}, 0), m, 1}};
  const std::vector<EdgeCut> along = {{edge(2, 2, 2, 1), at(n, {2, 2, 2}, 1), n, 2},
                                      {edge(3, 2, 2, 1), at(n, {3, 2, 2}, 1), n, 2}};
  for (const bool turned : {false, true}) {
    body = support::with_placed_skin(support::block({4, 4, 4}));
    cut(turned ? along : across);
    cut(turned ? across : along);
    expect_near(face_point(), {2.5, 2.5, 2});
  }
}

TEST_F(Inside, TheCentreMinimisesTheQuadricOfAllPlanes) {
  // A sphere around (0, 2.5, 2.5) cuts four lines along x: by symmetry the minimum is on the axis, where the sum of the
  // squared distances to the four tangent planes vanishes: at their common pole.
  const double to_chord = 2.4, radius2 = to_chord * to_chord + 0.5;
  std::vector<EdgeCut> cuts;
  for (const EdgeId e : body.grid.edges(cell))
    if (body.grid.axis(e) == 0) {
      const Vec3 p = body.grid.position(body.grid.ends(e)[0]);
      cuts.push_back({e, to_chord - 2, (Vec3(to_chord, p[1], p[2]) - Vec3(0, 2.5, 2.5)).normalized(), 1});
    }
  cut(cuts);
  const Vec3 pole(radius2 / to_chord, 2.5, 2.5);
  for (const auto& c : cuts)
    EXPECT_NEAR(c.normal.dot(pole - grid::edge_point(body, c.edge)), 0, 1e-15);
  expect_near(cell_point(), pole, 1e-14);
}

TEST_F(Inside, WhatWouldLeaveIsHeldAndCounted) {
  // From (2.5, 2.5) the nearest point of this plane has x < 2; across y = 2 it does not. The cut has (2.05, 2) in it and
  // leaves the cell at x = 2: the vertex lies halfway.
  const double lean = std::numbers::pi / 6;
  const Vec3 normal(std::cos(lean), std::sin(lean), 0);
  const auto counts = cut({{edge(2, 2, 2, 0), 0.05, normal, 1}});
  EXPECT_EQ(counts.n_placed, 8u);
  EXPECT_EQ(counts.n_clamped, 3u) << "one face and the two cells beside it";
  for (const Vec3& p : {face_point(), cell_point()}) {
    EXPECT_NEAR(normal.dot(p), normal.dot(Vec3(2.05, 2, 0)), 1e-9);
    EXPECT_GT(p[0], 2);
    EXPECT_LT(p[0], 2.05);
  }
  EXPECT_NEAR(face_point()[0], 2.025, 1e-9);
}

/// No vertex leaves its face or cell, with room for the octants.
void expect_all_inside(const Body& body) {
  const double h = body.grid.h(), margin = 0.25 * grid::min_edge_parameter * h;
  for (const auto c : ids<CellId>(body.grid.n_cells())) {
    const Vec3 lower = body.grid.origin(c) + Vec3::Constant(margin);
    const Vec3 upper = body.grid.origin(c) + Vec3::Constant(h - margin);
    ASSERT_TRUE((Box{lower, upper}.contains(grid::cell_point(body, c))));
    for (int face = 0; face < 6; ++face) {
      Vec3 p = grid::face_point(body, body.grid.faces(c)[face]);
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

/// Each tetrahedron of an octant is spanned by a way along the cell's edges from the node: its volume is a product of
/// three lengths that the clamp keeps positive.
void expect_positive_octants(const Body& body, std::size_t& n_tetrahedra, double& smallest) {
  for (const auto c : ids<CellId>(body.grid.n_cells()))
    for (int v = 0; v < 8; ++v)
      for (const auto& t : grid::octant(body, c, v)) {
        const auto way = [&](const Vec3& p, const int axis) { return std::abs(p[axis] - (v >> axis & 1)); };
        // The point on the edge, then the one in the face: the order is turned where the octant is a mirror image.
        const bool in_order = (way(t[1], 0) > 0) + (way(t[1], 1) > 0) + (way(t[1], 2) > 0) == 1;
        const Vec3 &e = in_order ? t[1] : t[2], &f = in_order ? t[2] : t[1];
        int first = 0;
        while (way(e, first) == 0)
          ++first;
        const int second = way(f, (first + 1) % 3) > 0 ? (first + 1) % 3 : (first + 2) % 3, third = 3 - first - second;
        const double product = way(e, first) * way(f, second) * way(t[3], third) / 6, volume = support::volume(t);
        ASSERT_NEAR(volume / product, 1, 1e-12);
        ASSERT_GT(way(e, first), 0.25 * grid::min_edge_parameter);
        ASSERT_GT(way(f, second), 0.25 * grid::min_edge_parameter);
        ASSERT_GT(way(t[3], third), 0.25 * grid::min_edge_parameter);
        ++n_tetrahedra;
        smallest = std::min(smallest, volume);
      }
}

TEST(Placement, EveryOctantIsPositiveWhereverVerticesAreHeld) {
  Random random(15);
  const Body sphere = support::embedded(geometry::sphere_mesh(1, Vec3::Zero(), 3), 0.31, {0.2, 0.4, 0.9});
  std::size_t n_tetrahedra = 0, n_placed = 0, n_clamped = 0;
  double smallest = 1;
  for (int i = 0; i < 30; ++i) {
    Body body = i % 2 ? sphere : support::block({3, 3, 4}, 0.1);
    for (grid::CutLabel label = 1; label <= 3; ++label) {
      const auto counts = support::cut(body, support::random_cuts(random, body, uniform(random, 0, 0.5), label));
      n_placed += counts.n_placed;
      n_clamped += counts.n_clamped;
      expect_positive_octants(body, n_tetrahedra, smallest);
      ASSERT_FALSE(testing::Test::HasFailure()) << "body " << i;
    }
  }
  std::cout << n_tetrahedra << " tetrahedra, the smallest of " << smallest << " h^3; " << n_clamped << " of "
            << n_placed << " vertices clamped\n";
  EXPECT_GT(smallest, 0);
  EXPECT_GT(n_clamped, 1000u);
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
      const auto s = build_surface(support::with_copies(body));
      worst = std::max(worst, worst_skin_distance(s, box));
      worst_volume = std::max(worst_volume, std::abs(enclosed_volume(s.rest, s.triangles) / 0.231556 - 1));
    }
  }
  std::cout << "skin off its plane by at most " << worst << " m, volume off by at most " << worst_volume << '\n';
  EXPECT_LT(worst, 1e-14);
  EXPECT_LT(worst_volume, 1e-12);
}

} // namespace
} // namespace kerf::surface::placement_test
