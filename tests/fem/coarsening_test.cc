#include "fem/coarsening.h"

#include "base/parallel.h"
#include "tests/fem/bodies.h"

#include <gtest/gtest.h>

namespace kerf::fem::coarsening_test {
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

struct Weight {
  std::uint32_t fine, coarse; // corners
  float weight;

  auto operator<=>(const Weight&) const = default;
};

/// Of all corners, by fine corner.
std::vector<Weight> weights_of(const Coarsening& coarsening, const CellsOfLevel& cells) {
  std::vector<Weight> weights;
  for (std::uint32_t corner = 0; corner < cells.n_corners; ++corner)
    coarsening.for_each_weight(corner, [&](const std::uint32_t coarse, const float weight) {
      weights.push_back({corner, coarse, weight});
    });
  return weights;
}

/// The same, in the order in which they are asked of coarse copies.
std::vector<Weight> weights_by_copy(const Coarsening& coarsening) {
  std::vector<Weight> weights;
  for (std::size_t copy = 0; copy < coarsening.coarse.n_copies(); ++copy)
    coarsening.for_each_corner(copy, [&](const std::uint32_t corner, const VertexWeights& of_vertices) {
      for (std::uint32_t k = 0; k < of_vertices.n; ++k)
        weights.push_back(
          {corner, coarsening.coarse.corners[8 * copy + of_vertices.vertex[k]], of_vertices.weight[k]});
    });
  return weights;
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
    EXPECT_EQ(weights_of(shared, cells), weights_of(alone, cells));
    EXPECT_EQ(weights_by_copy(shared), weights_by_copy(alone));
  }
  set_n_threads(1);
}

/// Whoever has a fine corner says the same of it: trilinear motions of the coarse corners are taken over as they are.
TEST(Coarsening, WeightsAreThoseOfEveryCopyWithACorner) {
  const CellsOfLevel cells = cells_of(slit_block());
  const Coarsening coarsening = coarsened(cells);
  for (std::size_t i = 0; i < cells.corners.size(); ++i) {
    const std::uint32_t parent = coarsening.parent[i / 8];
    double sum = 0;
    coarsening.for_each_weight(cells.corners[i], [&](const std::uint32_t corner, const float weight) {
      const auto of_parent = std::span(coarsening.coarse.corners).subspan(8 * std::size_t(parent), 8);
      ASSERT_NE(std::ranges::find(of_parent, corner), of_parent.end()) << i;
      sum += weight;
    });
    ASSERT_EQ(sum, 1) << i;
  }
}

TEST(Coarsening, EveryCornerIsAskedOfOneCopy) {
  const CellsOfLevel cells = cells_of(slit_block());
  const Coarsening coarsening = coarsened(cells);
  std::vector<Weight> by_copy = weights_by_copy(coarsening), by_corner = weights_of(coarsening, cells);
  ASSERT_GT(by_corner.size(), cells.n_corners);
  std::ranges::sort(by_copy);
  std::ranges::sort(by_corner);
  EXPECT_EQ(by_copy, by_corner);
}

} // namespace
} // namespace kerf::fem::coarsening_test
