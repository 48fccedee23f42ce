/// Cuts and the octants they bound.

#include "grid/material.h"

#include "grid/cube.h"
#include "tests/grid/histories.h"
#include "tests/support/bodies.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <map>
#include <stdexcept>

namespace kerf::grid {
namespace {

using support::Body;
using support::Random;
using support::uniform;

/// A number between 0 and 1, in the margins of the allowed range one time in three.
double anywhere(Random& random) {
  const int which = std::uniform_int_distribution<int>(0, 5)(random);
  return which == 0 ? min_edge_parameter : which == 1 ? 1 - min_edge_parameter : uniform(random, 0.001, 0.999);
}

TEST(Cuts, AreKeptByEdge) {
  Body body = support::block({2, 2, 2});
  const EdgeId e = *body.grid.find_edge({1, 1, 1}, 0);
  EXPECT_FALSE(body.cuts.is_cut(e));
  EXPECT_EQ(body.cuts.find(e), nullptr);
  EXPECT_EQ(edge_point(body, e), Vec3(1.5, 1, 1));
  const std::size_t n = body.cuts.all().size();
  body.cuts.add(body.grid, {e, 0.25, Vec3::UnitZ(), 3});
  ASSERT_NE(body.cuts.find(e), nullptr);
  EXPECT_EQ(body.cuts.find(e)->label, 3);
  EXPECT_EQ(body.cuts.find(e)->normal, Vec3(0, 0, 1));
  EXPECT_EQ(body.cuts.all().size(), n + 1);
  EXPECT_EQ(edge_point(body, e), Vec3(1.25, 1, 1));
  EXPECT_THROW(body.cuts.add(body.grid, {e, 0.5, Vec3::UnitX(), 1}), std::logic_error);
}

TEST(Cuts, MayBeTwoOnAnEdgeOfTheSkin) {
  // The skin is at 0.5 on each of them; the node is at the upper end of the first, at the lower end of the second.
  for (const bool node_is_above : {true, false}) {
    Body body = support::block({1, 1, 1});
    const EdgeId e = *body.grid.find_edge({node_is_above ? 0 : 1, 1, 1}, 0);
    const double t = node_is_above ? 0.8 : 0.2;
    EXPECT_FALSE(body.cuts.is_cut_twice(e));
    EXPECT_EQ(body.cuts.find(e), body.cuts.find_outer(e));
    EXPECT_EQ(body.cuts.index(e), body.cuts.outer_index(e));
    EXPECT_EQ(body.cuts.n_cut_twice(), 0u);
    EXPECT_TRUE(body.cuts.can_be_cut(body.grid, e));
    const std::uint32_t skin = body.cuts.index(e);
    const std::size_t n = body.cuts.all().size();

    body.cuts.add(body.grid, {e, t, Vec3::UnitZ(), 3});
    EXPECT_TRUE(body.cuts.is_cut(e));
    EXPECT_TRUE(body.cuts.is_cut_twice(e));
    EXPECT_EQ(body.cuts.n_cut_twice(), 1u);
    EXPECT_EQ(body.cuts.all().size(), n + 1);
    EXPECT_EQ(body.cuts.index(e), n);
    EXPECT_EQ(body.cuts.outer_index(e), skin);
    EXPECT_EQ(body.cuts.find(e), &body.cuts.all()[n]);
    EXPECT_EQ(body.cuts.find_outer(e), &body.cuts.all()[skin]);
    EXPECT_EQ(body.cuts.find(e)->t, t);
    EXPECT_EQ(body.cuts.find(e)->label, 3);
    EXPECT_EQ(body.cuts.find(e)->normal, Vec3(0, 0, 1));
    EXPECT_EQ(body.cuts.find_outer(e)->t, 0.5);
    EXPECT_EQ(body.cuts.find_outer(e)->label, skin_label);
    EXPECT_NEAR(edge_point(body, e)[0], node_is_above ? 0.8 : 1.2, 1e-15);
    EXPECT_EQ(edge_skin_point(body, e), Vec3(node_is_above ? 0.5 : 1.5, 1, 1));
    EXPECT_FALSE(body.cuts.can_be_cut(body.grid, e));
    EXPECT_THROW(body.cuts.add(body.grid, {e, node_is_above ? 0.9 : 0.1, Vec3::UnitX(), 1}), std::logic_error);
    EXPECT_EQ(body.cuts.all().size(), n + 1) << "refused, and left alone";
    EXPECT_EQ(body.cuts.n_cut_twice(), 1u);
  }
}

TEST(Cuts, OfTheSkinLieAboveTheSecondOne) {
  Random random(9);
  auto nodes = support::some_nodes(random, {3, 3, 3}, 0.5);
  nodes.push_back({2, 2, 2});
  const Body body = support::make_body({}, nodes, [&](const Grid& grid, const EdgeId e) {
    EdgeCut cut = support::midway(grid, e);
    cut.t = anywhere(random);
    return cut;
  });
  std::size_t n_taken = 0, n_refused = 0;
  for (const EdgeId e : body.grid.skin_edges())
    for (const double t : {-1.0, 0.0, min_edge_parameter, body.cuts.find(e)->t, uniform(random, 0, 1),
                           1 - min_edge_parameter, 1.0, 2.0}) {
      Cuts cuts = body.cuts;
      const double clamped = std::clamp(t, min_edge_parameter, 1 - min_edge_parameter), skin = cuts.find(e)->t;
      const bool is_below = body.grid.is_material(body.grid.ends(e)[0]) ? clamped < skin : clamped > skin;
      if (is_below) {
        cuts.add(body.grid, {e, t, Vec3::UnitX(), 1});
        EXPECT_EQ(cuts.find(e)->t, clamped);
        EXPECT_EQ(cuts.find_outer(e)->t, skin);
        ++n_taken;
      } else {
        EXPECT_THROW(cuts.add(body.grid, {e, t, Vec3::UnitX(), 1}), std::logic_error);
        EXPECT_FALSE(cuts.is_cut_twice(e));
        EXPECT_EQ(cuts.find(e)->t, skin);
        ++n_refused;
      }
    }
  EXPECT_GT(n_taken, 100u);
  EXPECT_GT(n_refused, 100u);
}

TEST(Cuts, SayWhatMayStillBeCut) {
  Random random(10);
  auto nodes = support::some_nodes(random, {4, 4, 4}, 0.6);
  Body body = support::make_body({}, nodes, support::midway);
  const auto plan = histories::random_plan(random, body, 0.4, 0.5, 0);
  std::size_t n_second = 0;
  std::map<EdgeId, int> n_cuts;
  for (const EdgeCut& cut : plan.cuts) {
    body.cuts.add(body.grid, cut);
    ++n_cuts[cut.edge];
    n_second += !support::is_inner(body, cut.edge);
  }
  EXPECT_EQ(body.cuts.n_cut_twice(), n_second);
  std::array<std::size_t, 3> n_edges{};
  for (const auto e : ids<EdgeId>(body.grid.n_edges())) {
    const auto& [lower, upper] = body.grid.ends(e);
    const int n_material = int(body.grid.is_material(lower)) + int(body.grid.is_material(upper));
    EXPECT_EQ(body.cuts.can_be_cut(body.grid, e), n_material > 0 && n_cuts[e] == 0);
    EXPECT_EQ(body.cuts.is_cut(e), n_material == 1 || n_cuts[e] > 0);
    EXPECT_EQ(body.cuts.is_cut_twice(e), n_material == 1 && n_cuts[e] > 0);
    ++n_edges[n_material];
  }
  for (const std::size_t n : n_edges)
    EXPECT_GT(n, 10u) << "edges outside, of the skin, inside";
}

TEST(Cuts, KeepWhatIsSaidOfTheSkin) {
  Body body = support::block({2, 2, 2});
  for (const auto f : ids<FaceId>(body.grid.n_faces())) {
    EXPECT_EQ(body.cuts.seam(f), Seam::unsaid);
    body.cuts.set_seam(f, f.value % 2 ? Seam::whole : Seam::parted);
  }
  for (const auto f : ids<FaceId>(body.grid.n_faces()))
    EXPECT_EQ(body.cuts.seam(f), f.value % 2 ? Seam::whole : Seam::parted);
  body.cuts.set_seam(FaceId(1), Seam::parted);
  EXPECT_EQ(body.cuts.seam(FaceId(1)), Seam::parted);
}

TEST(Cuts, StayInsideTheirEdge) {
  Body body = support::block({3, 2, 2});
  for (const double t : {-1.0, 0.0, 1e-300, 1.0, 7.0}) {
    Cuts cuts(body.grid);
    const EdgeId e = *body.grid.find_edge({1, 1, 1}, 0);
    cuts.add(body.grid, {e, t, Vec3::UnitX(), 1});
    EXPECT_GE(cuts.find(e)->t, min_edge_parameter);
    EXPECT_LE(cuts.find(e)->t, 1 - min_edge_parameter);
  }
}

TEST(Cuts, GiveTheLineBitsOfACell) {
  Random random(2);
  Body body = support::block({3, 3, 3});
  for (const auto& cut : support::random_cuts(random, body, 0.4))
    body.cuts.add(body.grid, cut);
  for (const auto c : ids<CellId>(body.grid.n_cells()))
    for (int line = 0; line < 12; ++line)
      EXPECT_EQ((body.cuts.configuration(body.grid, c) >> line & 1) == 1, body.cuts.is_cut(body.grid.edges(c)[line]));
}

TEST(Cuts, KeepThePointsOfFacesAndCells) {
  Body body = support::block({2, 2, 2}, 0.5);
  const CellId c = *body.grid.find_cell({1, 1, 1});
  for (int face = 0; face < 6; ++face) {
    Vec3 middle = Vec3::Constant(0.75);
    middle[face / 2] = face & 1 ? 1 : 0.5;
    const FaceId f = body.grid.faces(c)[face];
    EXPECT_EQ(centre(body.grid, f), middle);
    EXPECT_EQ(body.cuts.point(f), nullptr);
    EXPECT_EQ(face_point(body, f), middle);
    body.cuts.set_point(f, middle + Vec3::Constant(face));
    body.cuts.set_point(f, middle - Vec3::Constant(face));
    EXPECT_EQ(face_point(body, f), middle - Vec3::Constant(face));
  }
  EXPECT_EQ(centre(body.grid, c), Vec3(0.75, 0.75, 0.75));
  EXPECT_EQ(cell_point(body, c), Vec3(0.75, 0.75, 0.75));
  body.cuts.set_point(c, {0.6, 0.7, 0.8});
  EXPECT_EQ(cell_point(body, c), Vec3(0.6, 0.7, 0.8));
}

TEST(Cuts, KeepThePointsOfTheSkin) {
  Body body = support::block({1, 1, 1});
  const CellId c = *body.grid.find_cell({1, 1, 1});
  for (int face = 0; face < 6; ++face) {
    const FaceId f = body.grid.faces(c)[face];
    EXPECT_EQ(body.cuts.skin_point(f), nullptr);
    const Vec3 of_cuts = centre(body.grid, f) + Vec3(0.1, 0.1, 0.1), of_skin(face, 2, 3);
    body.cuts.set_point(f, of_cuts);
    for (int i = 0; i < 4; ++i)
      EXPECT_EQ(face_skin_point(body, f, i), of_cuts) << "the same where the skin has none of its own";
    SkinPoint point;
    point.p = of_skin;
    body.cuts.set_skin_point(f, point);
    for (int i = 0; i < 4; ++i)
      EXPECT_EQ(face_skin_point(body, f, i), of_skin);
    point.lines = 0b0100;
    body.cuts.set_skin_point(f, point);
    for (int i = 0; i < 4; ++i)
      EXPECT_EQ(face_skin_point(body, f, i), i == 2 ? of_skin : of_cuts);
    EXPECT_EQ(face_point(body, f), of_cuts);
    for (int i = 0; i < 4; ++i)
      EXPECT_EQ(cube::place_in_face(face, cube::face_lines[face][i]), i);
  }
  EXPECT_EQ(body.cuts.skin_point(c), nullptr);
  const Vec3 middle = centre(body.grid, c);
  SkinPoint point;
  point.p = {7, 8, 9};
  point.lines = 1 << 5 | 1 << 11;
  body.cuts.set_skin_point(c, point);
  for (int line = 0; line < 12; ++line)
    EXPECT_EQ(cell_skin_point(body, c, line), line == 5 || line == 11 ? point.p : middle);
}

TEST(Octants, TileTheirCellForEveryPositionOfThePoints) {
  Random random(3);
  const double h = 0.1;
  const Body blank = support::block({2, 2, 2}, h);
  const CellId c = *blank.grid.find_cell({1, 1, 1});
  for (int i = 0; i < 2000; ++i) {
    Body body{blank.grid, Cuts(blank.grid)};
    for (const EdgeId e : blank.grid.edges(c))
      if (uniform(random, 0, 1) < 0.8)
        body.cuts.add(blank.grid, {e, anywhere(random), Vec3::UnitX(), 1});
    const auto random_point = [&] {
      return Vec3(blank.grid.origin(c) + h * Vec3(anywhere(random), anywhere(random), anywhere(random)));
    };
    for (int face = 0; face < 6; ++face) {
      Vec3 p = random_point();
      p[face / 2] = blank.grid.origin(c)[face / 2] + (face & 1 ? h : 0);
      body.cuts.set_point(blank.grid.faces(c)[face], p);
    }
    body.cuts.set_point(c, random_point());
    double sum = 0;
    for (int v = 0; v < 8; ++v)
      for (const auto& t : octant(body, c, v)) {
        ASSERT_GT(volume(t), 0) << "cell " << i << " octant " << v;
        sum += volume(t);
      }
    ASSERT_NEAR(sum, 1, 1e-13);
  }
}

TEST(Octants, OfAnUncutCellAreEighths) {
  const Body body = support::block({2, 2, 2}, 0.25);
  const CellId c = *body.grid.find_cell({1, 1, 1});
  for (int v = 0; v < 8; ++v) {
    double sum = 0;
    for (const auto& t : octant(body, c, v)) {
      sum += volume(t);
      for (const Vec3& p : t)
        for (int axis = 0; axis < 3; ++axis)
          EXPECT_LE(std::abs(p[axis] - (v >> axis & 1)), 0.5);
    }
    EXPECT_NEAR(sum, 0.125, 1e-15);
  }
}

} // namespace
} // namespace kerf::grid
