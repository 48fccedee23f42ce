#include "fem/coarsening.h"

#include "base/parallel.h"
#include "tests/fem/bodies.h"

#include <gtest/gtest.h>

namespace kerf::fem {
namespace {

CellsOfLevel cells_of(const Body& body) {
  CellsOfLevel cells;
  for (const grid::Copy& copy : body.complex.copies) {
    cells.place.push_back(body.grid.index(body.grid.nodes(copy.cell)[0]));
    for (const grid::CornerId corner : copy.corners)
      cells.corners.push_back(corner.value);
  }
  cells.n_corners = body.complex.n_corners();
  return cells;
}

/// A block that is slit here and there, with fronts at which one copy has two above it.
Body slit_block() {
  Draw draw(97);
  Body body = make_block({30, 20, 20}, 0.1, draw, {0.4, 0.6});
  std::vector<grid::EdgeCut> cuts;
  for (const auto e : ids<grid::EdgeId>(body.grid.n_edges())) {
    const auto [lower, upper] = body.grid.ends(e);
    const Index3 at = body.grid.index(lower);
    if (body.grid.is_material(lower) && body.grid.is_material(upper) && body.grid.axis(e) == at[0] % 3 &&
        at[body.grid.axis(e)] % 4 == 1 && draw(0, 1) < 0.8)
      cuts.push_back({e, 0.5, Vec3::Unit(body.grid.axis(e)), 1});
  }
  body.cut(cuts);
  return body;
}

void expect_same(const Weights& a, const Weights& b) {
  EXPECT_EQ(a.begin, b.begin);
  EXPECT_EQ(a.column, b.column);
  EXPECT_EQ(a.weight, b.weight);
}

TEST(Coarsening, IsTheSameWithAnyNumberOfThreads) {
  const CellsOfLevel cells = cells_of(slit_block());
  ASSERT_GT(cells.n_copies(), 13500u);
  const Coarsening alone = coarsened(cells);
  for (const int n : {2, 3}) {
    set_n_threads(n);
    const Coarsening shared = coarsened(cells);
    EXPECT_EQ(shared.parent, alone.parent);
    EXPECT_EQ(shared.octant, alone.octant);
    EXPECT_EQ(shared.children.all, alone.children.all);
    EXPECT_EQ(shared.coarse.place, alone.coarse.place);
    EXPECT_EQ(shared.coarse.corners, alone.coarse.corners);
    expect_same(shared.prolongation, alone.prolongation);
    expect_same(shared.restriction, alone.restriction);
  }
  set_n_threads(1);
}

/// Whoever has a fine corner says the same of it: trilinear motions of the coarse corners are taken over as they are.
TEST(Coarsening, WeightsAreThoseOfEveryCopyWithACorner) {
  const CellsOfLevel cells = cells_of(slit_block());
  const Coarsening coarsening = coarsened(cells);
  const auto& [begin, column, weight] = coarsening.prolongation;
  for (std::size_t i = 0; i < cells.corners.size(); ++i) {
    const std::uint32_t corner = cells.corners[i], parent = coarsening.parent[i / 8];
    double sum = 0;
    for (std::uint32_t k = begin[corner]; k < begin[corner + 1]; ++k) {
      const auto of_parent = std::span(coarsening.coarse.corners).subspan(8 * std::size_t(parent), 8);
      ASSERT_NE(std::ranges::find(of_parent, column[k]), of_parent.end()) << i;
      sum += weight[k];
    }
    ASSERT_EQ(sum, 1) << i;
  }
}

} // namespace
} // namespace kerf::fem
