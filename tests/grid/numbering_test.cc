/// The grid's tables of runs against sorted lists of every single node, edge, face and cell: numbers and all that is
/// told of each of them.

#include "base/error.h"
#include "grid/cube.h"
#include "grid/grid.h"
#include "tests/support/bodies.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <stdexcept>

namespace kerf::grid::numbering_test {
namespace {

using support::Random;

/// By z, then y, then x.
struct RowOrder {
  bool operator()(const Index3& a, const Index3& b) const {
    return std::lexicographical_compare(a.rbegin(), a.rend(), b.rbegin(), b.rend());
  }
};

/// Lattice points in the grid's order.
class Sorted {
 public:
  void insert(const Index3& i) { number_[i] = 0; }
  /// Numbers all from `first`; returns what follows the last.
  std::size_t number(std::size_t first = 0) {
    for (auto& [i, number] : number_)
      number = first++;
    return first;
  }
  /// Invalid where there is none.
  template <class Key>
  Key find(const Index3& i) const {
    const auto found = number_.find(i);
    return found == number_.end() ? Key() : Key(found->second);
  }
  const std::map<Index3, std::size_t, RowOrder>& all() const { return number_; }

 private:
  std::map<Index3, std::size_t, RowOrder> number_;
};

Index3 plus(Index3 i, const Index3& move) {
  for (int d = 0; d < 3; ++d)
    i[d] += move[d];
  return i;
}

Index3 vertex(const int v) { return {v & 1, v >> 1 & 1, v >> 2 & 1}; }
Index3 minus_vertex(const int v) { return {-(v & 1), -(v >> 1 & 1), -(v >> 2 & 1)}; }

struct PlainGrid {
  Sorted material, cells, nodes;
  std::array<Sorted, 3> edges, faces;
  std::size_t n_edges = 0, n_faces = 0;

  explicit PlainGrid(const std::vector<Index3>& material_nodes) {
    for (const Index3& m : material_nodes) {
      material.insert(m);
      for (int v = 0; v < 8; ++v)
        cells.insert(plus(m, minus_vertex(v)));
    }
    for (const auto& [c, number] : cells.all()) {
      for (int v = 0; v < 8; ++v)
        nodes.insert(plus(c, vertex(v)));
      for (const auto& line : cube::line_vertices)
        edges[line[1] - line[0] == 1 ? 0 : line[1] - line[0] == 2 ? 1 : 2].insert(plus(c, vertex(line[0])));
      for (int face = 0; face < 6; ++face)
        faces[face / 2].insert(plus(c, vertex(cube::face_vertices[face][0])));
    }
    material.number();
    cells.number();
    nodes.number();
    for (int axis = 0; axis < 3; ++axis) {
      n_edges = edges[axis].number(n_edges);
      n_faces = faces[axis].number(n_faces);
    }
  }
};

void expect_nodes(const Grid& grid, const PlainGrid& plain) {
  ASSERT_EQ(grid.n_nodes(), plain.nodes.all().size());
  for (const auto& [i, number] : plain.nodes.all()) {
    const NodeId n(number);
    ASSERT_EQ(grid.index(n), i);
    ASSERT_EQ(grid.is_material(n), plain.material.all().contains(i));
    ASSERT_EQ(grid.cell(n), plain.cells.find<CellId>(i));
    for (int axis = 0; axis < 3; ++axis)
      ASSERT_EQ(grid.edge(n, axis), plain.edges[axis].find<EdgeId>(i));
    ASSERT_EQ(grid.find_node(i), n);
  }
}

void expect_edges(const Grid& grid, const PlainGrid& plain) {
  ASSERT_EQ(grid.n_edges(), plain.n_edges);
  std::vector<EdgeId> skin;
  for (int axis = 0; axis < 3; ++axis)
    for (const auto& [i, number] : plain.edges[axis].all()) {
      const EdgeId e(number);
      Index3 upper = i;
      ++upper[axis];
      ASSERT_EQ(grid.axis(e), axis);
      ASSERT_EQ(grid.ends(e)[0], plain.nodes.find<NodeId>(i));
      ASSERT_EQ(grid.ends(e)[1], plain.nodes.find<NodeId>(upper));
      for (int k = 0; k < 4; ++k) {
        Index3 lower = i;
        lower[(axis + 1) % 3] -= k & 1;
        lower[(axis + 2) % 3] -= k >> 1;
        ASSERT_EQ(grid.cells(e)[k], plain.cells.find<CellId>(lower));
      }
      if (plain.material.all().contains(i) != plain.material.all().contains(upper))
        skin.push_back(e);
    }
  EXPECT_EQ(grid.skin_edges(), skin);
}

void expect_faces(const Grid& grid, const PlainGrid& plain) {
  ASSERT_EQ(grid.n_faces(), plain.n_faces);
  for (int axis = 0; axis < 3; ++axis)
    for (const auto& [i, number] : plain.faces[axis].all()) {
      Index3 below = i;
      --below[axis];
      ASSERT_EQ(grid.cells(FaceId(number))[0], plain.cells.find<CellId>(below));
      ASSERT_EQ(grid.cells(FaceId(number))[1], plain.cells.find<CellId>(i));
    }
}

void expect_cells(const Grid& grid, const PlainGrid& plain) {
  ASSERT_EQ(grid.n_cells(), plain.cells.all().size());
  for (const auto& [i, number] : plain.cells.all()) {
    const CellId c(number);
    for (int v = 0; v < 8; ++v)
      ASSERT_EQ(grid.nodes(c)[v], plain.nodes.find<NodeId>(plus(i, vertex(v))));
    for (int line = 0; line < 12; ++line)
      ASSERT_EQ(grid.edges(c)[line],
                plain.edges[cube::line_axis(line)].find<EdgeId>(plus(i, vertex(cube::line_vertices[line][0]))));
    for (int face = 0; face < 6; ++face) {
      Index3 beside = i;
      beside[face / 2] += face & 1 ? 1 : -1;
      ASSERT_EQ(grid.faces(c)[face], plain.faces[face / 2].find<FaceId>(plus(i, vertex(cube::face_vertices[face][0]))));
      ASSERT_EQ(grid.neighbour(c, face), plain.cells.find<CellId>(beside));
    }
  }
}

void expect_same(const Grid& grid, const PlainGrid& plain) {
  expect_nodes(grid, plain);
  expect_edges(grid, plain);
  expect_faces(grid, plain);
  expect_cells(grid, plain);
}

/// Runs of material nodes, cut into parts that meet and overlap.
std::vector<NodeRun> random_runs(Random& random, const std::vector<Index3>& nodes) {
  Sorted sorted;
  for (const Index3& i : nodes)
    sorted.insert(i);
  std::vector<NodeRun> runs;
  for (const auto& [i, number] : sorted.all()) {
    const bool goes_on =
      !runs.empty() && runs.back().last + 1 == i[0] && runs.back().y == i[1] && runs.back().z == i[2];
    if (!goes_on || support::uniform(random, 0, 1) < 0.2) {
      const bool overlaps = goes_on && support::uniform(random, 0, 1) < 0.5;
      runs.push_back({overlaps ? i[0] - 1 : i[0], i[0], i[1], i[2]});
    } else
      runs.back().last = i[0];
  }
  return runs;
}

TEST(GridNumbering, IsThatOfSortedLists) {
  Random random(11);
  std::size_t n_split = 0;
  for (int i = 0; i < 80; ++i) {
    const Index3 n = {1 + i % 40, 1 + i / 5 % 6, 1 + i / 7 % 5};
    const double density = support::uniform(random, 0.02, 1.05);
    auto material = support::some_nodes(random, n, density);
    if (material.empty())
      material = {{n[0], n[1], 1}};
    if (i % 3 == 0)
      material.push_back({900 + i, 3, 700});
    const PlainGrid plain(material);
    std::shuffle(material.begin(), material.end(), random);
    expect_same(Grid({{0.3, -2, 7}, 0.37}, material), plain);
    const auto runs = random_runs(random, material);
    n_split += runs.size();
    expect_same(Grid::from_runs({}, runs), plain);
    ASSERT_FALSE(HasFailure()) << "random set " << i;
  }
  EXPECT_GT(n_split, 1000u);
}

/// Long runs, whose points are found by the run of their block.
TEST(GridNumbering, IsThatOfSortedListsForLongRuns) {
  Random random(12);
  std::vector<Index3> material;
  for (int y = 1; y < 8; ++y)
    for (int z = 1; z < 8; ++z)
      for (int x = 1 + (y * z) % 37; x < 150; ++x)
        if ((x * 7 + y) % 53 != 0 && support::uniform(random, 0, 1) > 0.01)
          material.push_back({x, y, z});
  expect_same(Grid({}, material), PlainGrid(material));
}

TEST(GridNumbering, ReachesTheEndsOfTheLattice) {
  constexpr int last = (1 << 20) - 2;
  std::vector<Index3> material;
  for (const int x : {1, last})
    for (const int y : {1, last})
      for (const int z : {1, 2, last})
        material.push_back({x, y, z});
  expect_same(Grid({}, material), PlainGrid(material));
}

TEST(GridNumbering, RefusesRunsInAnotherOrder) {
  EXPECT_THROW(Grid::from_runs({}, {{3, 4, 2, 1}, {1, 1, 1, 1}}), std::logic_error);
  EXPECT_THROW(Grid::from_runs({}, {{3, 2, 1, 1}}), std::logic_error);
  EXPECT_THROW(Grid::from_runs({}, {{0, 2, 1, 1}}), DataError);
  EXPECT_THROW(Grid::from_runs({}, {{1, 1 << 20, 1, 1}}), DataError);
  EXPECT_THROW(Grid::from_runs({}, {}), DataError);
}

} // namespace
} // namespace kerf::grid::numbering_test
