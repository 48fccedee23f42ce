/// The grid against sets and maps of lattice coordinates.

#include "grid/grid.h"

#include "base/error.h"
#include "grid/cube.h"
#include "tests/support/bodies.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace kerf::grid::grid_test {
namespace {

using support::Random;
using Indices = std::set<Index3>;

Index3 moved(Index3 i, const int axis, const int by) {
  i[axis] += by;
  return i;
}

/// Vertex v of the cell at `lower`.
Index3 vertex(const Index3& lower, const int v) {
  return {lower[0] + (v & 1), lower[1] + (v >> 1 & 1), lower[2] + (v >> 2 & 1)};
}

/// What must be stored, from the definition: every cell that touches a material node, and all that belongs to it.
struct Expected {
  Indices cells, nodes;
  std::array<Indices, 3> edges, faces; ///< by axis

  explicit Expected(const std::vector<Index3>& material) {
    for (const Index3& m : material)
      for (int v = 0; v < 8; ++v)
        cells.insert({m[0] - (v & 1), m[1] - (v >> 1 & 1), m[2] - (v >> 2 & 1)});
    for (const Index3& c : cells)
      for (int v = 0; v < 8; ++v) {
        nodes.insert(vertex(c, v));
        for (int axis = 0; axis < 3; ++axis) {
          if (!(v >> axis & 1))
            edges[axis].insert(vertex(c, v));
          if ((v & ~(1 << axis)) == 0)
            faces[axis].insert(vertex(c, v));
        }
      }
  }
};

void expect_cells(const Grid& grid, const Expected& expected) {
  ASSERT_EQ(grid.n_cells(), expected.cells.size());
  Indices seen;
  for (const auto c : ids<CellId>(grid.n_cells())) {
    const Index3 lower = grid.index(grid.nodes(c)[0]);
    seen.insert(lower);
    EXPECT_EQ(grid.find_cell(lower), c);
    EXPECT_EQ(grid.origin(c), grid.lattice().position(lower));
    for (int v = 0; v < 8; ++v)
      EXPECT_EQ(grid.index(grid.nodes(c)[v]), vertex(lower, v));
    for (int line = 0; line < 12; ++line) {
      const EdgeId e = grid.edges(c)[line];
      for (int end = 0; end < 2; ++end)
        EXPECT_EQ(grid.ends(e)[end], grid.nodes(c)[cube::line_vertices[line][end]]);
      EXPECT_EQ(grid.axis(e), cube::line_axis(line));
    }
    for (int face = 0; face < 6; ++face) {
      const int axis = face / 2, upper = face & 1;
      const auto& sides = grid.cells(grid.faces(c)[face]);
      EXPECT_EQ(sides[1 - upper], c);
      const auto neighbour = grid.find_cell(moved(lower, axis, upper ? 1 : -1));
      EXPECT_EQ(sides[upper], neighbour.value_or(CellId()));
    }
  }
  EXPECT_EQ(seen, expected.cells);
}

void expect_nodes(const Grid& grid, const Expected& expected, const std::vector<Index3>& material) {
  const Indices is_material(material.begin(), material.end());
  ASSERT_EQ(grid.n_nodes(), expected.nodes.size());
  for (const Index3& i : expected.nodes) {
    const auto n = grid.find_node(i);
    ASSERT_TRUE(n.has_value());
    EXPECT_EQ(grid.index(*n), i);
    EXPECT_EQ(grid.is_material(*n), is_material.contains(i));
    EXPECT_EQ(grid.position(*n), grid.lattice().position(i));
  }
}

void expect_edges(const Grid& grid, const Expected& expected) {
  ASSERT_EQ(grid.n_edges(), expected.edges[0].size() + expected.edges[1].size() + expected.edges[2].size());
  std::set<EdgeId> seen;
  for (int axis = 0; axis < 3; ++axis)
    for (const Index3& lower : expected.edges[axis]) {
      const auto e = grid.find_edge(lower, axis);
      ASSERT_TRUE(e.has_value());
      seen.insert(*e);
      EXPECT_EQ(grid.axis(*e), axis);
      EXPECT_EQ(grid.index(grid.ends(*e)[0]), lower);
      EXPECT_EQ(grid.index(grid.ends(*e)[1]), moved(lower, axis, 1));
      std::set<CellId> around, found;
      for (int i = 0; i < 4; ++i)
        if (const auto c = grid.find_cell(moved(moved(lower, (axis + 1) % 3, -(i & 1)), (axis + 2) % 3, -(i >> 1))))
          around.insert(*c);
      for (const CellId c : grid.cells(*e))
        if (c.valid()) {
          EXPECT_TRUE(found.insert(c).second) << "a cell twice around an edge";
        }
      EXPECT_EQ(found, around);
    }
  EXPECT_EQ(seen.size(), grid.n_edges());
}

void expect_faces(const Grid& grid, const Expected& expected) {
  ASSERT_EQ(grid.n_faces(), expected.faces[0].size() + expected.faces[1].size() + expected.faces[2].size());
  std::set<FaceId> seen;
  for (const auto c : ids<CellId>(grid.n_cells()))
    for (const FaceId f : grid.faces(c))
      seen.insert(f);
  EXPECT_EQ(seen.size(), grid.n_faces());
}

/// find_* knows what is stored, and nothing else, in a box around it.
void expect_nothing_else(const Grid& grid, const Expected& expected, const Index3& n) {
  for (int i = -1; i <= n[0] + 2; ++i)
    for (int j = -1; j <= n[1] + 2; ++j)
      for (int k = -1; k <= n[2] + 2; ++k) {
        const Index3 at = {i, j, k};
        EXPECT_EQ(grid.find_node(at).has_value(), expected.nodes.contains(at));
        EXPECT_EQ(grid.find_cell(at).has_value(), expected.cells.contains(at));
        for (int axis = 0; axis < 3; ++axis)
          EXPECT_EQ(grid.find_edge(at, axis).has_value(), expected.edges[axis].contains(at));
      }
}

TEST(Grid, AgreesWithSetsOnRandomMaterial) {
  Random random(1);
  for (int i = 0; i < 60; ++i) {
    const Index3 n = {1 + i % 5, 1 + i / 5 % 4, 1 + i / 7 % 6};
    auto material = support::some_nodes(random, n, support::uniform(random, 0.05, 1));
    if (material.empty())
      material = {{1 + i % n[0], n[1], n[2]}};
    std::shuffle(material.begin(), material.end(), random);
    auto twice = material;
    twice.insert(twice.end(), material.begin(), material.begin() + static_cast<long>(material.size() / 2));
    const Grid grid({{0.3, -2, 7}, 0.37}, twice);
    const Expected expected(material);
    expect_cells(grid, expected);
    expect_nodes(grid, expected, material);
    expect_edges(grid, expected);
    expect_faces(grid, expected);
    expect_nothing_else(grid, expected, n);
    ASSERT_FALSE(HasFailure()) << "random set " << i;
  }
}

TEST(Grid, StoresOnlyWhatIsNearMaterial) {
  const Grid grid({}, {{1, 1, 1}, {1000, 2, 3}, {5, 1048574, 9}});
  EXPECT_EQ(grid.n_cells(), 24u);
  EXPECT_EQ(grid.n_nodes(), 81u);
  EXPECT_TRUE(grid.find_node({5, 1048575 - 1, 9}).has_value());
  EXPECT_FALSE(grid.find_node({5, 2, 9}).has_value());
}

TEST(Grid, RefusesWhatItCannotHold) {
  EXPECT_THROW(Grid({}, {}), DataError);
  for (int axis = 0; axis < 3; ++axis) {
    Index3 low = {1, 1, 1}, high = {1, 1, 1};
    low[axis] = 0;
    high[axis] = 1 << 20;
    EXPECT_THROW(Grid({}, {{2, 2, 2}, low}), DataError);
    EXPECT_THROW(Grid({}, {{2, 2, 2}, high}), DataError);
  }
}

} // namespace
} // namespace kerf::grid::grid_test
