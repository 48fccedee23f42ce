/// What the grid cannot show is not parted.

#include "tests/cut/patient.h"

#include <gtest/gtest.h>

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

} // namespace
} // namespace kerf::cut::shreds_test
