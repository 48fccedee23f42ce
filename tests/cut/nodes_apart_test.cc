/// What the skin joins although blades have parted it: told by the planes of their cuts; and when a blade that has gone
/// parts it.

#include "cut/nodes_apart.h"

#include "cut/open_ends.h"
#include "grid/parts.h"
#include "grid/touched.h"
#include "tests/grid/histories.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace kerf::cut {
namespace {

using grid::CellId;
using grid::EdgeId;
using grid::FaceId;
using grid::Seam;
using support::Body;
using support::Random;

/// Three nodes around the corner of a square whose fourth one is empty: the skin of that face joins the two at its
/// ends, when both edges to the corner are cut.
class ThreeNodes : public testing::Test {
 protected:
  Body body = support::make_body({Vec3::Zero(), 1}, {{1, 1, 1}, {2, 1, 1}, {1, 2, 1}}, support::midway);
  CellId cell = *body.grid.find_cell({1, 1, 1});
  FaceId face = body.grid.faces(cell)[4];
  EdgeId along_x = *body.grid.find_edge({1, 1, 1}, 0), along_y = *body.grid.find_edge({1, 1, 1}, 1);

  void cut(const Vec3& normal_on_x, const Vec3& normal_on_y) {
    body.cuts.add(body.grid, {along_x, 0.5, normal_on_x.normalized(), 1});
    body.cuts.add(body.grid, {along_y, 0.5, normal_on_y.normalized(), 1});
    body.cuts.set_seam(face, Seam::whole);
  }
};

TEST_F(ThreeNodes, StayTogetherOnOneSideOfAPlane) {
  cut({1, 1, 0}, {1, 1, 0});
  EXPECT_FALSE(must_be_parted(body, cell));
  EXPECT_TRUE(keep_nodes_apart(body, cell).empty());
  EXPECT_EQ(body.cuts.seam(face), Seam::whole);
}

TEST_F(ThreeNodes, AreKeptApartAcrossAPlane) {
  cut({1, 0, 0}, {0, 1, 0});
  EXPECT_TRUE(must_be_parted(body, cell));
  EXPECT_EQ(keep_nodes_apart(body, cell).size(), 2u);
  EXPECT_EQ(body.cuts.seam(face), Seam::parted);
  EXPECT_FALSE(must_be_parted(body, cell));
}

/// Only once the blade is more than a cell away, and no cut waits beside it.
TEST_F(ThreeNodes, AreKeptApartOnceTheBladeHasGone) {
  body.complex = grid::build_complex(body);
  const Points x = grid::rest_positions(body);
  cut({1, 0, 0}, {0, 1, 0});
  std::vector<CellId> cells;
  for (const auto& touched : grid::touched_cells(body.grid, std::vector{along_x, along_y}))
    cells.push_back(touched.cell);
  OpenEnds ends;
  ends.note(body, cells, 1);
  PendingCuts pending;
  const auto close = [&](const Vec3& blade) {
    const std::array<Vec3, 3> triangle = {blade, blade + Vec3::UnitX(), blade + Vec3::UnitY()};
    return ends.close(std::span(&triangle, 1), pending, body, x, 1).size();
  };
  OpenEnds of_another;
  of_another.note(body, cells, 2);
  EXPECT_EQ(of_another.size(), 0u) << "a blade that has not cut here ends nothing";
  EXPECT_EQ(close({1, 1, 1.5}), 0u);
  pending.push(std::vector<grid::EdgeCut>{{*body.grid.find_edge({2, 1, 1}, 0), 0.1, Vec3::UnitX(), 1}});
  EXPECT_EQ(close({9, 9, 9}), 0u);
  EXPECT_EQ(body.cuts.seam(face), Seam::whole);
  pending = {};
  EXPECT_GT(close({9, 9, 9}), 0u);
  EXPECT_EQ(body.cuts.seam(face), Seam::parted);
  EXPECT_EQ(ends.size(), 0u);
}

/// Do the cell's cuts have a plane between two of its nodes?
bool has_plane_between(const Body& body, const CellId c, const grid::CellCuts& cell, const Vec3& p, const Vec3& q) {
  for (int line = 0; line < grid::cube::n_lines; ++line)
    if (const EdgeId e = body.grid.edges(c)[line]; cell.blades() >> line & 1) {
      const Vec3 on = grid::edge_point(body, e), normal = body.cuts.find(e)->normal;
      const double a = normal.dot(p - on), b = normal.dot(q - on);
      if (a * b < 0 && std::min(std::abs(a), std::abs(b)) > 1e-9)
        return true;
    }
  return false;
}

/// Whatever seams say: afterwards no part of a cell holds two nodes across a plane that no edges join, and no face has
/// been parted in vain.
TEST(NodesApart, AfterAnyCutsAndSeams) {
  Random random(71);
  int n_joined = 0, n_parted = 0;
  for (int i = 0; i < 150; ++i) {
    Body body = support::make_body({Vec3::Zero(), 1}, support::some_nodes(random, {4, 4, 4}, 0.7), support::midway);
    const auto plan = grid::histories::random_plan(random, body, 0.4, 0.5, 0.5);
    body = grid::histories::applied(plan, std::move(body));
    for (const auto c : ids<CellId>(body.grid.n_cells())) {
      const auto faces = body.grid.faces(c);
      std::vector<Seam> before;
      for (const FaceId f : faces)
        before.push_back(body.cuts.seam(f));
      n_joined += must_be_parted(body, c);
      keep_nodes_apart(body, c);
      const grid::CellCuts cell = grid::cuts_of(body, c);
      const auto nodes = body.grid.nodes(c);
      for (const grid::Part& part : grid::parts_of(cell))
        for (int v = 0; v < 8; ++v)
          for (int w = 0; w < v; ++w)
            if ((part.nodes >> v & part.nodes >> w & 1) != 0 && (grid::cube::reachable(v, cell.cut) >> w & 1) == 0) {
              EXPECT_FALSE(
                has_plane_between(body, c, cell, body.grid.position(nodes[v]), body.grid.position(nodes[w])));
            }
      for (int k = 0; k < 6; ++k)
        if (body.cuts.seam(faces[k]) != before[k]) {
          ++n_parted;
          Body less = body;
          less.cuts.set_seam(faces[k], before[k]);
          EXPECT_TRUE(must_be_parted(less, c)) << "face " << k << " is parted in vain";
        }
    }
  }
  EXPECT_GT(n_joined, 100);
  EXPECT_GE(n_parted, n_joined);
}

} // namespace
} // namespace kerf::cut
