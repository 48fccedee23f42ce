/// Cells that a sweep passes without a cut: against points scattered over the sweep.

#include "cut/passed.h"

#include "cut/recut.h"
#include "grid/touched.h"
#include "tests/support/placed.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>

namespace kerf::cut::passed_test {
namespace {

using grid::CellId;
using grid::EdgeId;
using support::Body;
using support::Random;
using support::uniform;
using Strip = std::vector<std::array<Vec3, 3>>;

struct Resting {
  Body body;
  Points x = grid::rest_positions(body);
  EdgeBoxes boxes{body};
  PassedCells passed = {};

  Resting(Body whole) : body(support::with_copies(std::move(whole))) {}

  SweepCuts sweep(const Strip& strip) {
    boxes.fit(x);
    const auto found = cut_edges(strip, body, x, 1, &boxes);
    std::vector<SweptTriangle> swept;
    for (const auto& triangle : strip)
      swept.push_back({triangle});
    passed.pass(swept, found, body, x, x, boxes, 1);
    return found;
  }
  void cut(const SweepCuts& found) {
    for (const auto& cut : found.cuts) {
      passed.remove(body.grid.cells(cut.edge));
      body.cuts.add(body.grid, cut);
    }
    for (const auto& cut : found.of_skin) {
      passed.remove(grid::touched_cells(body.grid, {}, std::span(&cut.segment, 1)));
      body.cuts.add(cut);
    }
    surface::place(body, {});
    body.complex = grid::build_complex(body);
    x = grid::rest_positions(body);
    boxes = EdgeBoxes(body);
  }
};

Resting block(const int n) { return {support::with_placed_skin(support::block({n, n, n}))}; }

/// A parallelogram from `corner` along u and v.
Strip patch(const Vec3& corner, const Vec3& u, const Vec3& v) {
  return {{corner, corner + u, corner + u + v}, {corner, corner + u + v, corner + v}};
}

std::vector<CellId> cells(const PassedCells& passed) { return {passed.cells().begin(), passed.cells().end()}; }

TEST(Passed, APokeIsCountedInItsCell) {
  Resting body = block(5);
  const CellId cell = *body.body.grid.find_cell({2, 3, 3});
  EXPECT_TRUE(body.sweep(patch({2.3, 3.4, 3.5}, {0.2, 0, 0}, {0, 0.1, 0.2})).cuts.empty());
  EXPECT_EQ(cells(body.passed), std::vector<CellId>{cell});
  body.sweep(patch({2.3, 3.4, 3.5}, {0.2, 0, 0}, {0, 0.1, 0.2}));
  EXPECT_EQ(body.passed.cells().size(), 1u) << "a cell is counted once";
}

TEST(Passed, NothingIsCountedBesideTheBodyOrInAFace) {
  Resting body = block(5);
  body.sweep(patch({2.3, 3.4, 8}, {0.2, 0, 0}, {0, 0.1, 0.2}));
  body.sweep(patch({2.3, 0.1, 3.2}, {0.2, 0, 0}, {0, 0.3, 0.2})); // the empty half of a cell of the skin
  body.sweep(patch({2.3, 3, 3.2}, {0.2, 0, 0}, {0, 0, 0.3}));     // right between two cells
  EXPECT_TRUE(body.passed.cells().empty());
}

TEST(Passed, MaterialOfTheSkinCounts) {
  Resting body = block(5);
  body.sweep(patch({2.3, 0.6, 3.2}, {0.2, 0, 0}, {0, 0.1, 0.2}));
  EXPECT_EQ(cells(body.passed), std::vector<CellId>{*body.body.grid.find_cell({2, 0, 3})});
}

/// In steps that end in the middle of cells, those where the stroke begins are counted until their edges are cut.
TEST(Passed, AFrontLeavesNothingBehind) {
  Resting body = block(6);
  std::size_t n_most = 0, n_cut = 0;
  for (int step = 0; step < 20; ++step) {
    const double from = 1.1 + 0.41 * step, to = from + 0.41;
    const auto found = body.sweep(patch({3.3, -1, from}, {0, 9, 0}, {0, 0, to - from}));
    n_most = std::max(n_most, body.passed.cells().size());
    body.cut(found);
    n_cut += found.cuts.size();
  }
  EXPECT_EQ(n_cut, 30u);
  EXPECT_EQ(n_most, 5u) << "one row of cells; at its ends the skin is cut";
  EXPECT_TRUE(body.passed.cells().empty());
}

/// The cells whose material holds a point of the rest configuration, by the sides of all its tetrahedra.
std::vector<CellId> cells_with(const Resting& body, const Vec3& p) {
  std::vector<CellId> found;
  for (const auto c : ids<CellId>(body.body.grid.n_cells())) {
    const Vec3 local = (p - body.body.grid.origin(c)) / body.body.grid.h();
    if ((local.array() < 0).any() || (local.array() > 1).any())
      continue;
    for (const auto copy : body.body.complex.copies_of(c))
      grid::for_each_tetrahedron(body.body, body.body.complex.copies[copy], [&](const grid::Tetrahedron& t, int) {
        Mat3 sides;
        sides << t[1] - t[0], t[2] - t[0], t[3] - t[0];
        const Vec3 b = sides.inverse() * (local - t[0]);
        if ((b.array() > 1e-5).all() && b.sum() < 1 - 1e-5)
          found.push_back(c);
      });
  }
  return found;
}

/// Every cell in which a scattered point lies, without a cut edge, is counted; each that is counted is near the sweep.
TEST(Passed, AgreesWithScatteredPoints) {
  Random random(71);
  const Body ball = support::embedded(geometry::sphere_mesh(1, Vec3::Zero(), 3), 0.31, {0.3, 0.1, 0.8});
  std::size_t n_hit = 0, n_counted = 0;
  for (int i = 0; i < 60; ++i) {
    Resting body{ball};
    const Vec3 u = uniform(random, 0.02, 0.5) * support::random_direction(random);
    const Vec3 v = uniform(random, 0.02, 0.5) * support::random_direction(random);
    const Strip strip = patch(0.5 * support::random_vector(random), u, v);
    const auto found = body.sweep(strip);
    std::vector<CellId> met;
    for (const auto& cut : found.cuts)
      for (const CellId c : body.body.grid.cells(cut.edge))
        met.push_back(c);
    for (const auto& cut : found.of_skin)
      for (const CellId c : grid::touched_cells(body.body.grid, {}, std::span(&cut.segment, 1)))
        met.push_back(c);
    std::vector<CellId> hit;
    for (int k = 0; k < 1500; ++k)
      for (const CellId c : cells_with(body, strip[0][0] + uniform(random, 0, 1) * u + uniform(random, 0, 1) * v))
        if (std::find(met.begin(), met.end(), c) == met.end())
          hit.push_back(c);
    std::sort(hit.begin(), hit.end());
    hit.erase(std::unique(hit.begin(), hit.end()), hit.end());
    for (const CellId c : hit)
      EXPECT_TRUE(body.passed.cells().contains(c));
    for (const CellId c : body.passed.cells())
      EXPECT_EQ(std::count(met.begin(), met.end(), c), 0);
    n_hit += hit.size();
    n_counted += body.passed.cells().size();
  }
  EXPECT_GT(n_hit, 50u);
  EXPECT_LE(n_counted, n_hit + n_hit / 10) << "more cells than the points can have missed";
  std::cout << n_counted << " cells counted, in " << n_hit << " of them lies a point\n";
}

/// A body that stands elsewhere, deformed: the same cells.
TEST(Passed, FollowsTheBody) {
  Random random(72);
  Mat3 F;
  F << 1.2, 0.3, -0.1, -0.2, 0.8, 0.4, 0.1, 0.5, 1.5;
  const Vec3 shift(3, -1, 7);
  for (int i = 0; i < 20; ++i) {
    Resting at_rest = block(6), moved = block(6);
    const Vec3 from = Vec3::Constant(1.5) + 4 * support::random_offset(random);
    const Vec3 u = uniform(random, 0.1, 2) * support::random_direction(random),
               v = 0.3 * support::random_vector(random);
    at_rest.sweep(patch(from, u, v));
    for (Vec3& p : moved.x)
      p = F * p + shift;
    moved.sweep(patch(F * from + shift, F * u, F * v));
    EXPECT_EQ(cells(moved.passed), cells(at_rest.passed));
  }
}

/// A body that flies: the same cells as at rest, by what the blade sweeps relative to it, in a step by many cubes. And
/// a blade that goes with it passes none.
TEST(Passed, IsMetAsTheBladeMovesRelativeToIt) {
  Random random(73);
  std::size_t n = 0;
  for (int i = 0; i < 40; ++i) {
    Resting at_rest = block(6), flying = block(6);
    const Vec3 way = 9 * support::random_vector(random), from = Vec3::Constant(2) + 3 * support::random_offset(random);
    const Vec3 along = uniform(random, 0.1, 1) * support::random_direction(random),
               on = 0.3 * support::random_vector(random);
    at_rest.sweep(patch(from, along, on));
    BladePath path{{0, 0.3, 1}, {}}, beside = path;
    for (const double f : path.fractions) {
      path.lines.push_back({from + f * (on + way), from + along + f * (on + way)});
      beside.lines.push_back({Vec3(from + f * way + Vec3(20, 0, 0)), Vec3(from + along + f * way + Vec3(20, 0, 0))});
    }
    const Points before = flying.x;
    for (Vec3& p : flying.x)
      p += way;
    flying.boxes.fit(before, flying.x);
    for (const BladePath* const one : {&beside, &path}) {
      const auto found = cut_edges(*one, flying.body, before, flying.x, 1, &flying.boxes);
      flying.passed.pass(swept_triangles(*one), found, flying.body, before, flying.x, flying.boxes, 1);
      if (one == &beside) {
        EXPECT_TRUE(flying.passed.cells().empty());
      }
    }
    EXPECT_EQ(cells(flying.passed), cells(at_rest.passed));
    n += flying.passed.cells().size();
  }
  EXPECT_GT(n, 20u);
}

} // namespace
} // namespace kerf::cut::passed_test
