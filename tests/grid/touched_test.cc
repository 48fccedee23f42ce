#include "grid/touched.h"

#include "tests/support/bodies.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace kerf::grid {
namespace {

/// From every cell's own list of edges.
std::vector<TouchedCell> plainly(const Grid& grid, const std::vector<EdgeId>& edges) {
  std::vector<TouchedCell> touched;
  for (const CellId c : ids<CellId>(grid.n_cells())) {
    unsigned lines = 0;
    for (int line = 0; line < 12; ++line)
      if (std::find(edges.begin(), edges.end(), grid.edges(c)[line]) != edges.end())
        lines |= 1u << line;
    if (lines != 0)
      touched.push_back({c, static_cast<std::uint16_t>(lines)});
  }
  return touched;
}

TEST(TouchedCells, AreThoseOfAPlainSearch) {
  support::Random random(71);
  for (int i = 0; i < 60; ++i) {
    const Grid grid({Vec3::Zero(), 1}, support::some_nodes(random, {6, 5, 7}, i % 3 == 0 ? 2 : 0.4));
    std::vector<EdgeId> edges; // few, so that they are sorted, or many, so that they are marked
    const double probability = i % 2 ? 0.005 : 0.3;
    for (const EdgeId e : ids<EdgeId>(grid.n_edges()))
      if (support::uniform(random, 0, 1) < probability)
        edges.push_back(e);
    std::shuffle(edges.begin(), edges.end(), random);
    const auto touched = touched_cells(grid, edges), expected = plainly(grid, edges);
    ASSERT_EQ(touched.size(), expected.size());
    for (std::size_t k = 0; k < touched.size(); ++k) {
      ASSERT_EQ(touched[k].cell, expected[k].cell);
      ASSERT_EQ(touched[k].lines, expected[k].lines);
    }
  }
}

TEST(TouchedCells, OfNoEdgesAreNone) {
  EXPECT_TRUE(touched_cells(Grid({Vec3::Zero(), 1}, support::block_nodes({2, 2, 2})), {}).empty());
}

} // namespace
} // namespace kerf::grid
