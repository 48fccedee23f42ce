/// Fronts by themselves, in any cells and planes: what parts a cell and no other one (grid/fronts.h).

#include "cut/cell_at_plane.h"
#include "tests/fuzz/invariants.h"
#include "tests/fuzz/specimens.h"
#include "tests/fuzz/states.h"
#include "tests/support/placed.h"
#include "tests/support/same.h"

#include <gtest/gtest.h>

namespace kerf::fuzz::fronts_test {
namespace {

using grid::CellId;

/// In a plane through the cell, come some part of the way.
std::optional<grid::Front> random_front(const grid::Solid& solid, const CellId c, Random& random) {
  const double h = solid.grid.h();
  const Vec3 point = solid.grid.origin(c) + h * (Vec3::Constant(0.5) + 0.4 * support::random_vector(random));
  const cut::CellAtPlane cell(solid, c, {point, support::random_direction(random)}, cut::rest_of(solid, c));
  if (!cell.is_met())
    return std::nullopt;
  grid::Front front = cell.front(cell.section(), support::uniform(random, 0.02, 1));
  front.label = 1;
  return front.ahead != 0 ? std::optional(front) : std::nullopt;
}

void expect_sound(const grid::Solid& solid, const Items& items) {
  EXPECT_NO_THROW(require_sound_complex(solid, items));
  EXPECT_TRUE(support::renaming(solid.complex, grid::build_complex(solid)));
}

/// Copies are parted as if the planes were cut, corners are those that the whole cells ahead leave, and all is as it was
/// when fronts are taken back.
TEST(Fuzz, FrontsInAnyCells) {
  Random random(17);
  std::size_t n_fronts = 0;
  for (const Specimen& one : own_specimens().small)
    for (int round = 0; round < 6; ++round) {
      SCOPED_TRACE(one.name + ", round " + std::to_string(round));
      grid::Solid solid = support::with_copies(one.body);
      const grid::Solid whole = solid;
      std::vector<CellId> all, taken_back, left;
      for (const auto c : ids<CellId>(solid.grid.n_cells()))
        if (draw(random, 6) <= round)
          if (const auto front = random_front(solid, c, random)) {
            solid.cuts.set(*front);
            all.push_back(c);
            (draw(random, 2) ? taken_back : left).push_back(c);
          }
      n_fronts += all.size();
      grid::update_complex(solid, {}, {}, all);
      expect_sound(solid, one.items);
      for (auto* const cells : {&taken_back, &left}) {
        for (const CellId c : *cells)
          solid.cuts.take_back_front(c);
        grid::update_complex(solid, {}, {}, *cells);
        expect_sound(solid, one.items);
      }
      EXPECT_TRUE(support::renaming(solid.complex, whole.complex));
    }
  EXPECT_GT(n_fronts, 2000u);
}

} // namespace
} // namespace kerf::fuzz::fronts_test
