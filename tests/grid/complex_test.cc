/// The complex of copies on small bodies.

#include "grid/complex.h"

#include "tests/grid/complex_checks.h"
#include "tests/grid/histories.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <map>
#include <set>
#include <stdexcept>

namespace kerf::grid::complex_test {
namespace {

using histories::Plan;
using support::Random;
using support::uniform;

TEST(Complex, OfAnUncutBodyIsItsGrid) {
  for (const Index3& n : {Index3{1, 1, 1}, {2, 3, 4}, {1, 5, 2}}) {
    const Body body = support::with_copies(support::block(n, 0.5));
    const CellComplex& complex = body.complex;
    EXPECT_EQ(complex.n_copies(), body.grid.n_cells());
    EXPECT_EQ(complex.n_corners(), body.grid.n_nodes());
    EXPECT_EQ(grid::n_pieces(complex), 1u);
    const Points x = rest_positions(body);
    for (const auto corner : ids<CornerId>(complex.n_corners()))
      EXPECT_EQ(x[corner.value], body.grid.position(complex.node[corner]));
    expect_consistent(body, complex);
  }
}

TEST(Complex, HasTwoCopiesAtTheFaceOfAFront) {
  // Four nodes in a ring, its lower x edge cut, and the skin around that: the cell through the ring holds one
  // component, the one below it two.
  Body body = support::block({2, 1, 2});
  body.cuts.add(body.grid, {*body.grid.find_edge({1, 1, 1}, 0), 0.5, Vec3::UnitX(), 1});
  for (const SkinCut& cut : support::plane_skin_cuts(body, {Vec3::UnitX(), 1.5}))
    if (const auto& [f, c, place] = cut.segment; (f.valid() ? centre(body.grid, f) : centre(body.grid, c))[2] < 1.25)
      body.cuts.add(cut);
  const CellComplex complex = build_complex(body);
  const CellId below = *body.grid.find_cell({1, 1, 0}), above = *body.grid.find_cell({1, 1, 1});
  EXPECT_TRUE(complex.copies[complex.first_copy[below]].next.valid());
  EXPECT_FALSE(complex.copies[complex.first_copy[above]].next.valid());
  EXPECT_EQ(grid::n_pieces(complex), 1u);
  const CornerId left = complex.real_corner[*body.grid.find_node({1, 1, 1})];
  const Copy& joined = complex.copies[complex.copy_at(above, 0)];
  EXPECT_EQ(joined.corners[0], left);
  EXPECT_EQ(complex.copies[complex.copy_at(below, 4)].corners[5], joined.corners[1]) << "glued along the whole face";
  EXPECT_EQ(complex.copies[complex.copy_at(below, 5)].corners[4], joined.corners[0]) << "glued along the whole face";
  EXPECT_NE(complex.copies[complex.copy_at(below, 4)].corners[1], complex.copies[complex.copy_at(below, 5)].corners[1]);
}

/// A plane leaves nothing joined across it where it cuts all that it crosses, skin and all.
TEST(Complex, FallsApartAtAPlane) {
  Random random(12);
  for (int i = 0; i < 40; ++i) {
    auto nodes = support::some_nodes(random, {3, 3, 3}, uniform(random, 0.3, 1));
    nodes.push_back({2, 2, 2});
    const Body blank = support::make_body({}, nodes, [&](const Grid& grid, const EdgeId e) {
      EdgeCut cut = support::midway(grid, e);
      cut.t = uniform(random, 0.01, 0.99);
      return cut;
    });
    const Vec3 normal = support::random_direction(random);
    const support::Plane plane{normal, normal.dot(Vec3(2, 2, 2) + 0.5 * support::random_vector(random))};
    const Body body = support::with_copies(
      histories::applied({support::plane_cuts(blank, plane), support::plane_skin_cuts(blank, plane)}, blank));
    const Pieces all = pieces(body.complex);
    std::map<std::uint32_t, bool> is_above;
    for (const auto c : ids<CopyId>(body.complex.n_copies())) {
      const Copy& copy = body.complex.copies[c];
      for (grid::Items left = copy.items(); left != 0; left &= left - 1) {
        const bool above = plane.height(item_point(body, copy.cell, std::countr_zero(left))) >= 0;
        ASSERT_EQ(is_above.emplace(all.piece[c], above).first->second, above) << "random body " << i;
      }
    }
  }
}

TEST(Complex, GivesSkinThatIsCutOffCopiesOfItsOwn) {
  // One node in eight cells; its edge along x is cut a second time, then the skin around its end segment by segment.
  Body body = support::with_copies(support::block({1, 1, 1}));
  const CellComplex& complex = body.complex;
  const EdgeId edge = *body.grid.find_edge({1, 1, 1}, 0);
  const std::array<CellId, 4> around = body.grid.cells(edge);
  const auto expect = [&](const std::vector<EdgeId>& edges, const std::vector<SkinSegment>& segments,
                          const std::size_t n_copies, const std::size_t n_corners, const std::uint32_t n_pieces) {
    for (const EdgeId e : edges)
      body.cuts.add(body.grid, {e, 0.2, Vec3::UnitX(), 1});
    for (const SkinSegment& segment : segments)
      body.cuts.add({segment, 0.3, Vec3::UnitX(), 1});
    update_complex(body, edges, segments);
    EXPECT_EQ(complex.n_copies(), n_copies);
    EXPECT_EQ(complex.n_corners(), n_corners);
    EXPECT_EQ(grid::n_pieces(complex), n_pieces);
    expect_consistent(body, complex);
    expect_matches_slow(body, complex);
  };
  const auto half = [&](const int cell, const int face) { // of the arc in a face of one of the cells, at the edge
    const auto edges = body.grid.edges(around[cell]);
    const int line = static_cast<int>(std::ranges::find(edges, edge) - edges.begin());
    return SkinSegment::half(body.grid.faces(around[cell])[face], cube::place_in_face(face, line));
  };
  const auto spoke = [&](const int cell) {
    const auto edges = body.grid.edges(around[cell]);
    return SkinSegment::spoke(around[cell], static_cast<int>(std::ranges::find(edges, edge) - edges.begin()));
  };
  // The cells around the edge: 0 above it in y and z, 1 below in y, 2 below in z, 3 below in both.
  expect({edge}, {}, 8, 27, 1);                                 // the skin still holds all
  expect({}, {half(0, 2), half(0, 4), spoke(0)}, 9, 27 + 2, 1); // alone in the first cell: two on that cell's own edge
  expect({}, {half(1, 4), spoke(1)}, 10, 27 + 6, 1);            // in two cells side by side: six on their far side
  expect({}, {half(2, 2), spoke(2), spoke(3)}, 12, 27 + 18, 2); // on its own in four cells
}

/// Each item its own copy: nothing is glued but by what it is.
TEST(Complex, OfANodeWithAllCutFallsIntoItsItems) {
  Body body = support::block({1, 1, 1});
  for (const EdgeId e : body.grid.skin_edges())
    body.cuts.add(body.grid, {e, body.grid.is_material(body.grid.ends(e)[0]) ? 0.2 : 0.8, Vec3::UnitX(), 1});
  for (const SkinSegment& segment : histories::skin_segments(body.grid))
    body.cuts.add({segment, 0.5, Vec3::UnitX(), 1});
  EXPECT_EQ(body.cuts.skin_cuts().size(), 12u * 2 + 8 * 6);
  body.complex = build_complex(body);
  EXPECT_EQ(body.complex.n_copies(), 8u * (1 + 3 + 3 + 1));
  EXPECT_EQ(grid::n_pieces(body.complex), 1u + 6 + 12 + 8);
  expect_consistent(body, body.complex);
  expect_matches_slow(body, body.complex);
}

/// Does a part hold what was in several?
bool has_joined(const Body& before, const Body& after) {
  std::map<std::pair<Index3, slow::Item>, std::size_t> copy_of;
  const auto old = slow::slow_copies(before);
  for (std::size_t i = 0; i < old.size(); ++i)
    for (const auto& item : old[i].items)
      copy_of[{old[i].cell, item}] = i;
  for (const slow::SlowCopy& copy : slow::slow_copies(after)) {
    std::set<std::size_t> from;
    for (const auto& item : copy.items)
      from.insert(copy_of.at({copy.cell, item}));
    if (from.size() > 1)
      return true;
  }
  return false;
}

/// Where blades had cut at the skin of a cell, have they still?
bool is_cut_at_skin_still(const Body& before, const Body& after) {
  for (const auto c : ids<CellId>(before.grid.n_cells()))
    if (cuts_of(before, c).is_cut_at_skin() && !cuts_of(after, c).is_cut_at_skin())
      return false;
  return true;
}

/// Cuts that are taken back after the complex has been built with them.
TEST(Complex, RefusesExactlyTheCutsThatJoin) {
  Random random(7);
  int n_refused = 0, n_taken = 0;
  for (int i = 0; i < 300; ++i) {
    auto nodes = support::some_nodes(random, {2, 2, 2}, uniform(random, 0.3, 1));
    nodes.push_back({1, 1, 1});
    const Body blank = support::make_body({}, nodes, support::midway);
    const Plan plan =
      histories::random_plan(random, blank, uniform(random, 0, 1), uniform(random, 0.2, 1), uniform(random, 0.05, 1));
    if (plan.of_skin.empty())
      continue;
    const Body before = support::with_copies(histories::applied(plan, blank));
    Body after = before;
    const SkinSegment taken = plan.of_skin[random() % plan.of_skin.size()].segment;
    after.cuts.leave_whole(std::array{taken});
    const Plan more = histories::random_plan(random, after, 0, random() % 2 ? 0.2 : 0, 0);
    histories::apply(more, after);
    if (has_joined(before, after)) {
      EXPECT_THROW(update_complex(after, more.edges(), {taken}), std::logic_error);
      ++n_refused;
    } else if (is_cut_at_skin_still(before, after)) {
      ASSERT_NO_THROW(update_complex(after, more.edges(), {taken}));
      expect_same(after.complex, build_complex(after));
      ++n_taken;
    }
    ASSERT_FALSE(HasFatalFailure()) << "random body " << i;
  }
  EXPECT_GT(n_refused, 20);
  EXPECT_GT(n_taken, 50);
}

} // namespace
} // namespace kerf::grid::complex_test
