#include "cut/recut.h"

#include "base/error.h"
#include "base/parallel.h"
#include "base/union_find.h"
#include "cut/blade.h"
#include "cut/embed.h"
#include "cut/pending.h"
#include "cut/target.h"
#include "geometry/predicates.h"
#include "grid/cube.h"
#include "tests/geometry/meshes.h"
#include "tests/support/bodies.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <limits>
#include <map>
#include <random>
#include <set>

namespace kerf::cut::recut_test {
namespace {

using grid::EdgeCut;
using grid::EdgeId;
using grid::NodeId;

/// A block of cubes, its nodes at integers: 0.5, 1.5, ... would be its skin.
struct Block {
  static constexpr int n = 5;
  grid::Solid body = support::with_copies(
    embed(geometry::box_mesh(Vec3::Constant(-0.5), Vec3::Constant(n - 0.5)), 1, Vec3::Constant(0.5)).solid);
  Points x = grid::rest_positions(body);

  SweepCuts cut(const std::vector<std::array<Vec3, 3>>& strip) const { return cut_edges(strip, body, x, 1); }

  void take(const SweepCuts& found) {
    for (const EdgeCut& cut : found.cuts)
      body.cuts.add(body.grid, cut);
    for (const grid::SkinCut& cut : found.of_skin)
      body.cuts.add(cut);
  }

  bool is_inner(const EdgeId e) const {
    return body.grid.is_material(body.grid.ends(e)[0]) && body.grid.is_material(body.grid.ends(e)[1]);
  }

  /// Classes of material nodes joined by edges that are not cut.
  std::size_t n_classes(const std::vector<EdgeCut>& cuts) const {
    std::set<EdgeId> is_cut;
    for (const EdgeCut& c : cuts)
      is_cut.insert(c.edge);
    UnionFind classes(body.grid.n_nodes());
    for (const EdgeId e : ids<EdgeId>(body.grid.n_edges()))
      if (!body.cuts.is_cut(e) && !is_cut.contains(e))
        classes.unite(body.grid.ends(e)[0].value, body.grid.ends(e)[1].value);
    std::set<std::uint32_t> roots;
    for (const NodeId node : ids<NodeId>(body.grid.n_nodes()))
      if (body.grid.is_material(node))
        roots.insert(classes.root(node.value));
    return roots.size();
  }

  /// A cut edge between two nodes joins different classes: a cut has no edge too many.
  bool is_clean(const std::vector<EdgeCut>& cuts) const {
    return std::all_of(cuts.begin(), cuts.end(), [&](const EdgeCut& healed) {
      if (!is_inner(healed.edge))
        return true; // joins no nodes
      std::vector<EdgeCut> others;
      std::copy_if(cuts.begin(), cuts.end(), std::back_inserter(others),
                   [&](const EdgeCut& c) { return c.edge != healed.edge; });
      return n_classes(others) < n_classes(cuts);
    });
  }
};

/// A plane sweep: a straight edge from `from` along `along`, moved by `by` in `n_steps` sweeps.
std::vector<std::array<Vec3, 3>> plane_sweep(const Vec3& from, const Vec3& along, const Vec3& by, const int n_steps) {
  Blade blade{.name = "plane", .edge = {from}, .key_frames = {{0, Vec3::Zero(), Vec3::Zero()}, {1, by, Vec3::Zero()}}};
  for (int i = 1; i <= 4; ++i)
    blade.edge.push_back(from + along * i / 4);
  check(blade);
  std::vector<std::array<Vec3, 3>> strip;
  for (int k = 0; k < n_steps; ++k) {
    const auto part = sweep(blade, static_cast<double>(k) / n_steps, static_cast<double>(k + 1) / n_steps);
    strip.insert(strip.end(), part.begin(), part.end());
  }
  return strip;
}

class Planes : public testing::TestWithParam<int> {};

/// Axis planes through nodes, in faces, between nodes, ahead of and behind each other along each axis.
TEST_P(Planes, InAFaceSeparateIntoTwo) {
  const Block block;
  const int axis = GetParam();
  const Vec3 u = Vec3::Unit((axis + 1) % 3), v = Vec3::Unit((axis + 2) % 3);
  for (const double at : {0.5, 1.0, 1.25, 2.0, 3.0, 3.999})
    for (const double overhang : {1.0, 1.5, 2.0}) {
      const Vec3 from = at * Vec3::Unit(axis) - overhang * (u + v);
      const auto cuts = block.cut(plane_sweep(from, 8 * u, 8 * v, 4));
      EXPECT_EQ(cuts.n_double_crossings, 0u);
      EXPECT_EQ(cuts.cuts.size(), 25u);
      EXPECT_EQ(block.n_classes(cuts.cuts), 2u) << axis << ' ' << at;
      for (const EdgeCut& cut : cuts.cuts) {
        EXPECT_EQ(block.body.grid.axis(cut.edge), axis);
        const double lower = block.body.grid.position(block.body.grid.ends(cut.edge)[0])[axis];
        EXPECT_DOUBLE_EQ(lower + cut.t, at);
        EXPECT_NEAR(std::abs(cut.normal[axis]), 1, 1e-12);
      }
    }
}

INSTANTIATE_TEST_SUITE_P(Axes, Planes, testing::Range(0, 3));

/// Planes through many nodes and edges at once: normals (1,1,0), (1,1,1), (1,-2,0), ... through lattice points.
TEST(Recut, ObliquePlanesSeparateIntoTwo) {
  const Block block;
  const std::vector<std::pair<Vec3, Vec3>> directions = {
    {{1, -1, 0}, {0, 0, 1}}, {{1, 1, 0}, {0, 0, 1}}, {{1, -1, 0}, {0, 1, -1}}, {{2, 1, 0}, {0, 0, 1}},
    {{0, 1, 1}, {1, 0, 0}},  {{1, 0, 1}, {0, 1, 0}}, {{1, 1, 0}, {0, 1, 1}},   {{2, 1, 0}, {0, 1, 1}},
    {{1, 0, 2}, {0, 1, 1}},  {{1, -1, 1}, {1, 1, 0}}};
  for (const auto& [u, v] : directions)
    for (const Vec3& through : {Vec3(2, 2, 2), Vec3(2.5, 2, 2), Vec3(2, 1.5, 2.5), Vec3(1, 2, 3)}) {
      for (const auto& [along, by] : {std::pair{u, v}, std::pair{v, u}, std::pair<Vec3, Vec3>{-v, u}}) {
        const auto cuts = block.cut(plane_sweep(through - 16 * along - 16 * by, 32 * along, 32 * by, 8));
        EXPECT_EQ(block.n_classes(cuts.cuts), 2u) << u.transpose() << " | " << v.transpose();
        EXPECT_TRUE(block.is_clean(cuts.cuts));
        EXPECT_EQ(cuts.n_double_crossings, 0u);
        for (const EdgeCut& cut : cuts.cuts)
          EXPECT_NEAR(std::abs(cut.normal.dot(u.cross(v).normalized())), 1, 1e-12);
      }
    }
}

/// Every loop of four edges is cut evenly by a sweep that goes through: no leak in a face.
TEST(Recut, FacesAreCutEvenly) {
  const Block block;
  const auto cuts = block.cut(plane_sweep(Vec3(-14, 18, -16), Vec3(32, -32, 0), Vec3(0, 0, 32), 3)).cuts;
  std::set<EdgeId> is_cut;
  for (const EdgeCut& c : cuts)
    is_cut.insert(c.edge);
  ASSERT_FALSE(is_cut.empty());
  const grid::Grid& grid = block.body.grid;
  for (const auto c : ids<grid::CellId>(grid.n_cells()))
    for (int face = 0; face < 6; ++face) {
      const auto& lines = grid::cube::face_lines[face];
      const auto is_inside = [&](const int v) { return grid.is_material(grid.nodes(c)[v]); };
      if (!std::all_of(grid::cube::face_vertices[face].begin(), grid::cube::face_vertices[face].end(), is_inside))
        continue;
      const auto is_line_cut = [&](const int line) { return is_cut.contains(grid.edges(c)[line]); };
      EXPECT_EQ(std::count_if(lines.begin(), lines.end(), is_line_cut) % 2, 0);
    }
}

/// However crooked the body: an edge is cut exactly when a plane sweep of 512 triangles parts its ends.
TEST(Recut, CrookedBodiesAreCutBySides) {
  Block block;
  std::mt19937 random(11);
  std::uniform_int_distribution<int> step(-2, 2); // quarters: many corners lie on the plane and on the strip's edges
  for (int round = 0; round < 20; ++round) {
    block.x = grid::rest_positions(block.body);
    for (Vec3& p : block.x)
      p += 0.25 * Vec3(step(random), step(random), step(random));
    const Vec3 from(-8, -8, 2), along(16, 0, 0), by(0, 16, 0);
    const auto strip = plane_sweep(from, along, by, 64);
    ASSERT_EQ(strip.size(), 512u);
    std::set<EdgeId> is_cut;
    for (const EdgeCut& cut : block.cut(strip).cuts)
      is_cut.insert(cut.edge);
    const grid::Grid& grid = block.body.grid;
    for (const EdgeId e : ids<EdgeId>(grid.n_edges())) {
      if (block.body.cuts.is_cut(e) || !grid.is_material(grid.ends(e)[0]))
        continue;
      const auto side = [&](const NodeId n) {
        return geometry::side(block.x[block.body.complex.real_corner[n].value],
                              {from, from + along, from + along + by});
      };
      ASSERT_EQ(is_cut.contains(e), side(grid.ends(e)[0]) != side(grid.ends(e)[1]));
    }
  }
}

/// A curved sweep: parts of it meet every edge once or twice, by brute force over all triangles.
TEST(Recut, AgreesWithBruteForceOnTurningBlades) {
  Block block;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> number(-1, 1);
  for (Vec3& p : block.x)
    p += 0.2 * Vec3(number(random), number(random), number(random));
  Blade blade{
    .name = "arc",
    .edge = {{-4, 0, -1}, {0, 0, 2}, {1, 0.5, 5}, {3, 1, 7}},
    .key_frames = {{0, {2, -2, 0}, {0, 0, -60}}, {1, {2, 2, 0}, {10, 0, 60}}, {2, {2.5, 6, 0}, {0, 20, 170}}}};
  const auto strip = sweep(blade, 0, 2);
  const auto cuts = block.cut(strip);
  std::size_t n_odd = 0, n_even = 0;
  std::size_t n_of_skin = 0;
  for (const EdgeId e : ids<EdgeId>(block.body.grid.n_edges())) {
    if (!block.body.cuts.can_be_cut(block.body.grid, e))
      continue;
    const EdgeEnds ends = ends_of(block.body, e);
    const auto [p, q] = ends.segment(block.x);
    std::size_t n = 0;
    double first = 2;
    for (const auto& triangle : strip)
      if (geometry::crosses(p, q, triangle)) {
        ++n;
        first = std::min(first, geometry::crossing_parameter(p, q, triangle));
      }
    n_even += n > 0 && n % 2 == 0 ? 1 : 0;
    if (n % 2 == 1) {
      ASSERT_LT(n_odd, cuts.cuts.size());
      EXPECT_EQ(cuts.cuts[n_odd].edge, e);
      EXPECT_EQ(cuts.cuts[n_odd].t, ends.from + first * (ends.to - ends.from));
      n_of_skin += !block.is_inner(e);
      ++n_odd;
    }
  }
  EXPECT_EQ(cuts.cuts.size(), n_odd);
  EXPECT_GE(cuts.n_double_crossings, n_even) << "segments of the skin beside";
  EXPECT_GT(n_odd, 20u);
  EXPECT_GT(n_of_skin, 5u);
}

/// The edges of the skin end at the skin, whichever of their nodes is empty, and wherever the body is.
TEST(Recut, EdgesOfTheSkinAreCutBelowTheSkin) {
  for (const Vec3& shift : {Vec3(0, 0, 0), Vec3(3, -1, 7)}) {
    Block block;
    for (Vec3& p : block.x)
      p += shift;
    for (int axis = 0; axis < 3; ++axis)
      for (const bool lower : {false, true})
        for (const double depth : {-0.1, 1e-6, 0.1, 0.3, 0.499}) { // below the skin, in cube edges
          const double at = lower ? -0.5 + depth : Block::n - 0.5 - depth;
          const Vec3 u = Vec3::Unit((axis + 1) % 3), v = Vec3::Unit((axis + 2) % 3);
          const auto cuts = block.cut(plane_sweep(shift + at * Vec3::Unit(axis) - 2 * (u + v), 9 * u, 9 * v, 2)).cuts;
          ASSERT_EQ(cuts.size(), depth < 0 ? 0u : 25u) << depth;
          for (const EdgeCut& cut : cuts) {
            EXPECT_FALSE(block.is_inner(cut.edge));
            EXPECT_EQ(block.body.grid.axis(cut.edge), axis);
            EXPECT_NEAR(block.body.grid.position(block.body.grid.ends(cut.edge)[0])[axis] + cut.t, at, 1e-12);
            EXPECT_NEAR(std::abs(cut.normal[axis]), 1, 1e-12);
          }
        }
  }
}

/// An edge of the skin is cut once more, and then no more.
TEST(Recut, EdgesOfTheSkinAreCutOnceMore) {
  Block block;
  const auto strip = plane_sweep(Vec3(-2, -2, -0.3), Vec3(9, 0, 0), Vec3(0, 9, 0), 1);
  const auto cuts = block.cut(strip).cuts;
  ASSERT_EQ(cuts.size(), 25u);
  for (const EdgeCut& cut : cuts)
    block.body.cuts.add(block.body.grid, cut);
  block.body.complex = grid::build_complex(block.body);
  block.x = grid::rest_positions(block.body);
  EXPECT_EQ(block.body.cuts.n_cut_twice(), 25u);
  EXPECT_TRUE(block.cut(strip).cuts.empty());
  EXPECT_TRUE(block.cut(plane_sweep(Vec3(-2, -2, -0.2), Vec3(9, 0, 0), Vec3(0, 9, 0), 1)).cuts.empty());
}

/// In an affinely deformed body a deformed plane cuts as the plane did at rest.
TEST(Recut, AffineBodiesAreCutAsAtRest) {
  Block block;
  const Vec3 from(-10, 1.3, -9), along(20, 1.1, 0.2), by(0.3, 2, 20);
  const auto at_rest = block.cut(plane_sweep(from, along, by, 1)).cuts;
  Mat3 F;
  F << 1.2, 0.3, -0.1, -0.2, 0.8, 0.4, 0.1, 0.5, 1.5;
  const Vec3 shift(3, -1, 7);
  for (Vec3& p : block.x)
    p = F * p + shift;
  const auto deformed = block.cut(plane_sweep(F * from + shift, F * along, F * by, 1)).cuts;
  ASSERT_EQ(deformed.size(), at_rest.size());
  ASSERT_GE(at_rest.size(), 25u);
  for (std::size_t i = 0; i < at_rest.size(); ++i) {
    EXPECT_EQ(deformed[i].edge, at_rest[i].edge);
    EXPECT_NEAR(deformed[i].t, at_rest[i].t, 1e-12);
    EXPECT_NEAR(std::abs(deformed[i].normal.dot(at_rest[i].normal)), 1, 1e-12);
  }
}

/// A body that is bent and cut before: the sweep still separates, in whatever pieces are there.
TEST(Recut, BentBodiesAreSeparated) {
  Block block;
  block.take(block.cut(plane_sweep(Vec3(-9, -9, 2.3), Vec3(20, 0, 0), Vec3(0, 20, 0), 1)));
  block.body.complex = grid::build_complex(block.body);
  ASSERT_EQ(grid::n_pieces(block.body.complex), 2u);
  block.x = grid::rest_positions(block.body);
  const grid::Pieces pieces = grid::pieces(block.body.complex);
  for (grid::CopyId c : ids<grid::CopyId>(block.body.complex.n_copies()))
    for (const grid::CornerId corner : block.body.complex.copies[c].corners)
      if (Vec3& p = block.x[corner.value]; pieces.piece[c] == 1 && p[2] < 50)
        p += Vec3(0.3, 0, 100 + 0.1 * p[0] * p[0]);
  const auto lower = block.cut(plane_sweep(Vec3(2, -9, -9), Vec3(0, 20, 0), Vec3(0, 0, 20), 2)).cuts;
  EXPECT_EQ(lower.size(), 15u) << "the other piece is elsewhere";
  EXPECT_EQ(block.n_classes(lower), 3u);
  const auto upper = block.cut(plane_sweep(Vec3(2, -9, 80), Vec3(0, 20, 0), Vec3(0, 0, 40), 2)).cuts;
  EXPECT_EQ(upper.size(), 10u);
  EXPECT_EQ(block.n_classes(upper), 3u);
}

TEST(Recut, ThereAndBackIsCountedAndCutsNothing) {
  const Block block;
  auto strip = plane_sweep(Vec3(-9, -9, 2.3), Vec3(20, 0, 0), Vec3(0, 20, 0), 1);
  const auto back = plane_sweep(Vec3(-9, 11, 2.4), Vec3(20, 0, 0), Vec3(0, -20, 0), 1);
  strip.insert(strip.end(), back.begin(), back.end());
  const auto cuts = block.cut(strip);
  EXPECT_TRUE(cuts.cuts.empty());
  EXPECT_TRUE(cuts.of_skin.empty());
  EXPECT_EQ(cuts.n_double_crossings, 25u + 20 * (1 + 3))
    << "edges; in a ring of 20 cells a half of an arc and three spokes each";
  EXPECT_TRUE(block.cut({}).cuts.empty());
}

TEST(Recut, RefusesCornersThatAreNotFinite) {
  Block block;
  block.x[7][1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(block.cut(plane_sweep(Vec3(-9, -9, 2.3), Vec3(20, 0, 0), Vec3(0, 20, 0), 1)), NumericalError);
}

TEST(Recut, OneAndTwoThreadsGiveTheSameBits) {
  const grid::Solid body =
    support::with_copies(embed(geometry::sphere_mesh(1, Vec3::Zero(), 4), 0.07, Vec3::Constant(0.5)).solid);
  const Points x = grid::rest_positions(body);
  const auto strip = plane_sweep(Vec3(-3, -3, 0.1), Vec3(6, 0.5, 0.2), Vec3(0, 6, 0.3), 5);
  set_n_threads(1);
  const auto one = cut_edges(strip, body, x, 1);
  set_n_threads(2);
  const auto two = cut_edges(strip, body, x, 1);
  ASSERT_GT(one.cuts.size(), 200u);
  ASSERT_EQ(one.cuts.size(), two.cuts.size());
  for (std::size_t i = 0; i < one.cuts.size(); ++i) {
    EXPECT_EQ(one.cuts[i].edge, two.cuts[i].edge);
    EXPECT_EQ(one.cuts[i].t, two.cuts[i].t);
    EXPECT_EQ(one.cuts[i].normal, two.cuts[i].normal);
  }
}

TEST(PendingCuts, ReleaseTwoEdgesACellInOrder) {
  Block block;
  const SweepCuts met = block.cut(plane_sweep(Vec3(-9, -9, 2.3), Vec3(20, 0, 0), Vec3(0, 20, 0), 1));
  block.take({{}, met.of_skin, 0});
  const auto& cuts = met.cuts;
  PendingCuts pending;
  pending.push(cuts);
  pending.push(cuts);
  EXPECT_EQ(pending.size(), cuts.size()) << "an edge waits once";

  std::vector<EdgeId> released;
  int n_releases = 0;
  for (; pending.size() > 0; ++n_releases) {
    ASSERT_LT(n_releases, 50);
    const auto oldest_waits = pending.size();
    std::map<std::uint32_t, int> n_cut;
    for (const EdgeCut& cut : pending.release(block.body)) {
      for (const auto cell : block.body.grid.cells(cut.edge))
        EXPECT_TRUE(!cell.valid() || ++n_cut[cell.value] <= PendingCuts::max_per_cell);
      block.body.cuts.add(block.body.grid, cut);
      released.push_back(cut.edge);
    }
    EXPECT_LT(pending.size(), oldest_waits) << "the oldest one always goes";
  }
  EXPECT_GT(n_releases, 1);
  EXPECT_EQ(released.front(), cuts.front().edge);
  EXPECT_EQ(released.size(), cuts.size());
  EXPECT_EQ(grid::n_pieces(grid::build_complex(block.body)), 2u);
}

/// Edges of the skin wait as others do, and go when they are cut twice.
TEST(PendingCuts, EdgesOfTheSkinWaitToo) {
  Block block;
  const auto cuts = block.cut(plane_sweep(Vec3(-9, -9, -1.05), Vec3(20, 0, 1), Vec3(0, 20, 1), 1)).cuts;
  const auto n_of_skin = static_cast<std::size_t>(
    std::count_if(cuts.begin(), cuts.end(), [&](const EdgeCut& cut) { return !block.is_inner(cut.edge); }));
  ASSERT_GT(n_of_skin, 5u);
  ASSERT_LT(n_of_skin, cuts.size());
  PendingCuts pending;
  pending.push(cuts);
  std::size_t n_released = 0, n_dropped = 0;
  for (int step = 0; pending.size() > 0; ++step) {
    ASSERT_LT(step, 50);
    const std::size_t n_waiting = pending.size();
    const auto released = pending.release(block.body);
    n_released += released.size();
    n_dropped += n_waiting - released.size() - pending.size();
    for (const EdgeCut& cut : released)
      block.body.cuts.add(block.body.grid, cut);
    if (step == 0) // another cut along the same edge comes first
      for (const EdgeCut& cut : cuts)
        if (!block.is_inner(cut.edge) && block.body.cuts.can_be_cut(block.body.grid, cut.edge)) {
          block.body.cuts.add(block.body.grid, cut);
          break;
        }
  }
  EXPECT_EQ(n_dropped, 1u);
  EXPECT_EQ(n_released, cuts.size() - 1);
  EXPECT_EQ(block.body.cuts.n_cut_twice(), n_of_skin);
}

TEST(PendingCuts, DropEdgesThatWereCutMeanwhile) {
  Block block;
  const auto cuts = block.cut(plane_sweep(Vec3(-9, -9, 2.3), Vec3(20, 0, 0), Vec3(0, 20, 0), 1)).cuts;
  PendingCuts pending;
  pending.push(cuts);
  for (const EdgeCut& cut : cuts)
    block.body.cuts.add(block.body.grid, cut);
  EXPECT_TRUE(pending.release(block.body).empty());
  EXPECT_EQ(pending.size(), 0u);
}

} // namespace
} // namespace kerf::cut::recut_test
