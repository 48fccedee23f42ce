/// What the grid cannot show is not parted.

#include "tests/cut/patient.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

namespace kerf::cut::shreds_test {
namespace {

/// A block of 4 x 2 x 2 cubes, cut by two flat blades `thickness` cubes apart with a layer of four nodes in between.
std::size_t pieces_of_two_passes(const double thickness, const grid::CutLabel second) {
  Patient patient(support::with_placed_skin(support::block({4, 2, 2})));
  const grid::Grid& grid = patient.body.grid;
  const double layer = grid.position(grid::NodeId(0))[0] + 2 * grid.h();
  for (const auto& [offset, label] : {std::pair{0.4 * thickness, grid::CutLabel(1)}, {-0.6 * thickness, second}}) {
    const Vec3 through(layer + offset * grid.h(), 2 * grid.h(), 2 * grid.h());
    patient.pass(straight(through, Vec3::UnitY(), Vec3::UnitZ(), 6 * grid.h(), 6 * grid.h(), label), 10,
                 Release::queued);
  }
  EXPECT_TRUE(patient.is_as_built());
  return grid::n_pieces(patient.body.complex);
}

TEST(Shreds, ShavingsOfOneBladeStay) {
  EXPECT_EQ(pieces_of_two_passes(0.2, 1), 2u);
  EXPECT_EQ(pieces_of_two_passes(1e-6, 1), 2u);
}

TEST(Shreds, ThickerSlicesAndThoseOfTwoBladesAreParted) {
  EXPECT_EQ(pieces_of_two_passes(0.3, 1), 3u);
  EXPECT_EQ(pieces_of_two_passes(0.2, 2), 3u);
  EXPECT_EQ(pieces_of_two_passes(1e-6, 2), 3u);
}

/// What was left whole is cut by who met it first, where he did, once something is met beside it: be that another edge,
/// or the same one by another blade.
TEST(Shreds, WhatWasLeftIsTakenUpAsItWasMet) {
  const Body whole = support::with_copies(support::with_placed_skin(support::block({5, 5, 5})));
  const grid::EdgeId left = whole.grid.edge(*whole.grid.find_node({2, 2, 2}), 0),
                     beside = whole.grid.edge(*whole.grid.find_node({2, 3, 2}), 0),
                     far = whole.grid.edge(*whole.grid.find_node({2, 2, 2}), 1);
  ASSERT_TRUE(left.valid() && beside.valid() && far.valid());
  for (const grid::EdgeId met : {left, beside, far}) {
    Patient patient{whole};
    grid::Cuts& cuts = patient.body.cuts;
    cuts.add(whole.grid, {left, 0.3, Vec3::UnitX(), 1});
    cuts.leave_whole(std::array{left});
    ASSERT_FALSE(cuts.is_cut(left));
    Cutter cutter = patient.cutter(2);
    SweepCuts found;
    (met == left ? found.later : found.cuts).push_back({met, 0.7, Vec3::UnitX(), 2});
    grid::CutChange change = cutter.cut(patient.body, found);
    ASSERT_TRUE(cuts.is_cut(left));
    EXPECT_EQ(cuts.find(left)->label, 1);
    EXPECT_EQ(cuts.find(left)->t, 0.3);
    EXPECT_EQ(cuts.n_left_whole(), 0u);
    EXPECT_TRUE(std::ranges::binary_search(change.edges, left));
    EXPECT_EQ(std::ranges::count(cuts.later_cuts(left), 2, &grid::LaterCut::label), met == left ? 1 : 0);
  }
  { // met by another blade that can cut it: that is the one whose cut it is, and the first one's comes later
    Patient patient{whole};
    grid::Cuts& cuts = patient.body.cuts;
    cuts.add(whole.grid, {left, 0.3, Vec3::UnitX(), 1});
    cuts.leave_whole(std::array{left});
    Cutter cutter = patient.cutter(2);
    SweepCuts found;
    found.cuts.push_back({left, 0.7, Vec3::UnitX(), 2});
    cutter.cut(patient.body, found);
    EXPECT_EQ(cuts.find(left)->label, 2);
    EXPECT_EQ(cuts.find(left)->t, 0.7);
    EXPECT_EQ(cuts.n_left_whole(), 0u);
    EXPECT_EQ(std::ranges::count(cuts.later_cuts(left), 1, &grid::LaterCut::label), 1);
  }
}

} // namespace
} // namespace kerf::cut::shreds_test
