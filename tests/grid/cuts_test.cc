/// Cuts and the octants they bound.

#include "grid/cuts.h"

#include "grid/cube.h"
#include "tests/support/bodies.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <stdexcept>

namespace kerf::grid {
namespace {

using support::Body;
using support::Random;
using support::uniform;

TEST(Cuts, AreKeptByEdge) {
  Body body = support::block({2, 2, 2});
  const EdgeId e = *body.grid.find_edge({1, 1, 1}, 0);
  EXPECT_FALSE(body.cuts.is_cut(e));
  EXPECT_EQ(body.cuts.find(e), nullptr);
  EXPECT_EQ(edge_point(body.grid, body.cuts, e), Vec3(1.5, 1, 1));
  const std::size_t n = body.cuts.all().size();
  body.cuts.add({e, 0.25, Vec3::UnitZ(), 3});
  ASSERT_NE(body.cuts.find(e), nullptr);
  EXPECT_EQ(body.cuts.find(e)->label, 3);
  EXPECT_EQ(body.cuts.find(e)->normal, Vec3(0, 0, 1));
  EXPECT_EQ(body.cuts.all().size(), n + 1);
  EXPECT_EQ(edge_point(body.grid, body.cuts, e), Vec3(1.25, 1, 1));
  EXPECT_THROW(body.cuts.add({e, 0.5, Vec3::UnitX(), 1}), std::logic_error);
}

TEST(Cuts, StayInsideTheirEdge) {
  Body body = support::block({3, 2, 2});
  for (const double t : {-1.0, 0.0, 1e-300, 1.0, 7.0}) {
    Cuts cuts(body.grid);
    const EdgeId e = *body.grid.find_edge({1, 1, 1}, 0);
    cuts.add({e, t, Vec3::UnitX(), 1});
    EXPECT_GE(cuts.find(e)->t, min_edge_parameter);
    EXPECT_LE(cuts.find(e)->t, 1 - min_edge_parameter);
  }
}

TEST(Cuts, GiveTheLineBitsOfACell) {
  Random random(2);
  Body body = support::block({3, 3, 3});
  for (const auto& cut : support::random_cuts(random, body, 0.4))
    body.cuts.add(cut);
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
    EXPECT_EQ(face_point(body.grid, body.cuts, f), middle);
    body.cuts.set_point(f, middle + Vec3::Constant(face));
    body.cuts.set_point(f, middle - Vec3::Constant(face));
    EXPECT_EQ(face_point(body.grid, body.cuts, f), middle - Vec3::Constant(face));
  }
  EXPECT_EQ(centre(body.grid, c), Vec3(0.75, 0.75, 0.75));
  EXPECT_EQ(cell_point(body.grid, body.cuts, c), Vec3(0.75, 0.75, 0.75));
  body.cuts.set_point(c, {0.6, 0.7, 0.8});
  EXPECT_EQ(cell_point(body.grid, body.cuts, c), Vec3(0.6, 0.7, 0.8));
}

/// A number between 0 and 1, in the margins of the allowed range one time in three.
double anywhere(Random& random) {
  const int which = std::uniform_int_distribution<int>(0, 5)(random);
  return which == 0 ? min_edge_parameter : which == 1 ? 1 - min_edge_parameter : uniform(random, 0.001, 0.999);
}

double volume(const Tetrahedron& t) { return (t[1] - t[0]).dot((t[2] - t[0]).cross(t[3] - t[0])) / 6; }

TEST(Octants, TileTheirCellForEveryPositionOfThePoints) {
  Random random(3);
  const double h = 0.1;
  const Body blank = support::block({2, 2, 2}, h);
  const CellId c = *blank.grid.find_cell({1, 1, 1});
  for (int i = 0; i < 2000; ++i) {
    Cuts cuts(blank.grid);
    for (const EdgeId e : blank.grid.edges(c))
      if (uniform(random, 0, 1) < 0.8)
        cuts.add({e, anywhere(random), Vec3::UnitX(), 1});
    const auto random_point = [&] {
      return Vec3(blank.grid.origin(c) + h * Vec3(anywhere(random), anywhere(random), anywhere(random)));
    };
    for (int face = 0; face < 6; ++face) {
      Vec3 p = random_point();
      p[face / 2] = blank.grid.origin(c)[face / 2] + (face & 1 ? h : 0);
      cuts.set_point(blank.grid.faces(c)[face], p);
    }
    cuts.set_point(c, random_point());
    double sum = 0;
    for (int v = 0; v < 8; ++v)
      for (const auto& t : octant(blank.grid, cuts, c, v)) {
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
    for (const auto& t : octant(body.grid, body.cuts, c, v)) {
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
