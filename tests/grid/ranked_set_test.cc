#include "grid/ranked_set.h"

#include "grid/grid.h"
#include "grid/shape.h"
#include "tests/support/bodies.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace kerf::grid {
namespace {

using support::Random;

TEST(RankedSet, CountsMembersBelow) {
  Random random(3);
  for (const double density : {0.0, 0.01, 0.5, 1.0})
    for (const std::size_t n : {1, 63, 64, 65, 1000}) {
      RankedSet set(n);
      std::vector<std::size_t> members;
      for (std::size_t i = 0; i < n; ++i)
        if (support::uniform(random, 0, 1) < density) {
          set.push_back(i);
          members.push_back(i);
        }
      ASSERT_EQ(set.size(), members.size());
      for (std::size_t i = 0; i < n; ++i) {
        const auto found = std::lower_bound(members.begin(), members.end(), i);
        const bool is_member = found != members.end() && *found == i;
        ASSERT_EQ(set.place(i).has_value(), is_member);
        if (is_member) {
          ASSERT_EQ(*set.place(i), static_cast<std::size_t>(found - members.begin()));
        }
      }
    }
}

/// What is found by the lowest node is what is found by coordinates, and neighbours share their face.
TEST(Grid, FindsEdgesCellsAndNeighbours) {
  Random random(8);
  for (int i = 0; i < 20; ++i) {
    auto nodes = support::some_nodes(random, {5, 4, 6}, 0.3);
    nodes.push_back({3, 3, 3});
    const Grid grid({}, nodes);
    std::size_t n_edges = 0, n_cells = 0, n_neighbours = 0;
    for (const auto n : ids<NodeId>(grid.n_nodes())) {
      for (int axis = 0; axis < 3; ++axis) {
        const EdgeId e = grid.edge(n, axis);
        ASSERT_EQ(e.valid(), grid.find_edge(grid.index(n), axis).has_value());
        if (e.valid()) {
          ++n_edges;
          ASSERT_EQ(grid.ends(e)[0], n);
          ASSERT_EQ(grid.axis(e), axis);
        }
      }
      const CellId c = grid.cell(n);
      if (!c.valid())
        continue;
      ++n_cells;
      ASSERT_EQ(grid.nodes(c)[0], n);
      for (int face = 0; face < 6; ++face) {
        Index3 beside = grid.index(n);
        beside[face / 2] += face & 1 ? 1 : -1;
        ASSERT_EQ(grid.neighbour(c, face), grid.find_cell(beside).value_or(CellId()));
        n_neighbours += grid.neighbour(c, face).valid();
      }
    }
    EXPECT_EQ(n_edges, grid.n_edges());
    EXPECT_EQ(n_cells, grid.n_cells());
    EXPECT_GT(n_neighbours, grid.n_cells());
  }
}

TEST(Shape, FunctionsAreOneAtTheirVertexAndSumToOne) {
  Random random(9);
  for (int i = 0; i < 20; ++i) {
    const Vec3 xi = support::random_offset(random);
    double sum = 0;
    Vec3 sum_of_gradients = Vec3::Zero(), place = Vec3::Zero();
    for (int v = 0; v < 8; ++v) {
      const Vec3 vertex(v & 1, v >> 1 & 1, v >> 2 & 1);
      for (int w = 0; w < 8; ++w)
        EXPECT_EQ(shape(w, vertex), v == w ? 1 : 0);
      sum += shape(v, xi);
      place += shape(v, xi) * vertex;
      sum_of_gradients += shape_gradient(v, xi);
      for (int d = 0; d < 3; ++d) { // linear along each axis, so the difference is exact
        Vec3 low = xi, high = xi;
        low[d] = 0;
        high[d] = 1;
        EXPECT_NEAR(shape_gradient(v, xi)[d], shape(v, high) - shape(v, low), 1e-15);
      }
      EXPECT_EQ(shape(v, xi), shape(v, xi, 0xff));
    }
    EXPECT_NEAR(sum, 1, 1e-15);
    EXPECT_LT((place - xi).norm(), 1e-15);
    EXPECT_LT(sum_of_gradients.norm(), 1e-15);
    EXPECT_EQ(shape(1, xi, 0b00000011), xi[0]);
    EXPECT_NEAR(shape(6, xi, 0b01010101), xi[1] * xi[2], 1e-16); // in the face x = 0
  }
}

} // namespace
} // namespace kerf::grid
