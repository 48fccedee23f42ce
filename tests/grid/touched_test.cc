#include "grid/touched.h"

#include "tests/grid/histories.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace kerf::grid::touched_test {
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

TEST(TouchedCells, AreThoseOfSegmentsToo) {
  support::Random random(72);
  std::size_t n_by_segments = 0;
  for (int i = 0; i < 60; ++i) {
    auto nodes = support::some_nodes(random, {4, 5, 3}, i % 3 == 0 ? 2 : 0.4);
    nodes.push_back({1, 1, 1});
    const Grid grid({Vec3::Zero(), 1}, nodes);
    std::vector<EdgeId> edges;
    for (const EdgeId e : ids<EdgeId>(grid.n_edges()))
      if (support::uniform(random, 0, 1) < 0.01)
        edges.push_back(e);
    std::vector<SkinSegment> segments;
    for (const SkinSegment& segment : histories::skin_segments(grid))
      if (support::uniform(random, 0, 1) < (i % 2 ? 0.005 : 0.2))
        segments.push_back(segment);
    std::shuffle(segments.begin(), segments.end(), random);
    std::set<CellId> expected;
    for (const TouchedCell& touched : plainly(grid, edges))
      expected.insert(touched.cell);
    const std::size_t n_by_edges = expected.size();
    for (const CellId c : ids<CellId>(grid.n_cells())) {
      const auto faces = grid.faces(c);
      for (const SkinSegment& segment : segments)
        if (segment.cell == c || std::find(faces.begin(), faces.end(), segment.face) != faces.end())
          expected.insert(c);
    }
    n_by_segments += expected.size() - n_by_edges;
    ASSERT_EQ(touched_cells(grid, edges, segments), std::vector<CellId>(expected.begin(), expected.end()));
  }
  EXPECT_GT(n_by_segments, 1000u);
}

TEST(TouchedCells, OfNothingAreNone) {
  const Grid grid({Vec3::Zero(), 1}, support::block_nodes({2, 2, 2}));
  EXPECT_TRUE(touched_cells(grid, {}).empty());
  EXPECT_TRUE(touched_cells(grid, {}, {}).empty());
}

} // namespace
} // namespace kerf::grid::touched_test
