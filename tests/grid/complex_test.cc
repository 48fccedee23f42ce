/// The complex of copies against a slow one made from the definitions of grid/complex.h, on random cut sets and on embedded
/// bodies.

#include "grid/complex.h"

#include "cut/embed.h"
#include "geometry/solid.h"
#include "tests/geometry/meshes.h"
#include "tests/support/bodies.h"
#include "tests/support/same.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>
#include <set>

namespace kerf::grid {
namespace {

using support::Body;
using support::Random;
using NodeSet = std::set<Index3>;

/// A copy by its definition: a cell, and the material nodes of one component. Slots are its eight lattice places.
struct SlowCopy {
  Index3 cell;
  NodeSet nodes;
};

struct SlowComplex {
  std::vector<SlowCopy> copies;
  std::vector<std::array<int, 8>> instance; ///< names of node instances, by copy and vertex
  std::vector<int> piece;
};

Index3 vertex(const Index3& cell, const int v) {
  return {cell[0] + (v & 1), cell[1] + (v >> 1 & 1), cell[2] + (v >> 2 & 1)};
}

int local(const Index3& cell, const Index3& node) {
  return (node[0] - cell[0]) + 2 * (node[1] - cell[1]) + 4 * (node[2] - cell[2]);
}

bool inside(const Index3& cell, const Index3& node) {
  for (int axis = 0; axis < 3; ++axis)
    if (node[axis] < cell[axis] || node[axis] > cell[axis] + 1)
      return false;
  return true;
}

bool is_material(const Body& body, const Index3& i) {
  const auto n = body.grid.find_node(i);
  return n && body.grid.is_material(*n);
}

/// The nodes one uncut edge away.
std::vector<Index3> neighbours(const Body& body, const Index3& node) {
  std::vector<Index3> result;
  for (int axis = 0; axis < 3; ++axis)
    for (const int step : {-1, 1}) {
      Index3 other = node;
      other[axis] += step;
      const auto e = body.grid.find_edge(std::min(node, other), axis);
      if (e && !body.cuts.is_cut(*e))
        result.push_back(other);
    }
  return result;
}

NodeSet flood(const Body& body, const Index3& from, const std::function<bool(const Index3&)>& allowed) {
  NodeSet reached = {from};
  std::vector<Index3> open = {from};
  while (!open.empty()) {
    const Index3 node = open.back();
    open.pop_back();
    for (const Index3& other : neighbours(body, node))
      if (allowed(other) && reached.insert(other).second)
        open.push_back(other);
  }
  return reached;
}

std::vector<SlowCopy> slow_copies(const Body& body) {
  std::vector<SlowCopy> copies;
  for (const auto c : ids<CellId>(body.grid.n_cells())) {
    const Index3 cell = body.grid.index(body.grid.nodes(c)[0]);
    NodeSet seen;
    for (int v = 0; v < 8; ++v) {
      const Index3 node = vertex(cell, v);
      if (!is_material(body, node) || seen.contains(node))
        continue;
      copies.push_back({cell, flood(body, node, [&](const Index3& i) { return inside(cell, i); })});
      seen.insert(copies.back().nodes.begin(), copies.back().nodes.end());
    }
  }
  return copies;
}

std::vector<std::pair<int, int>> glued_pairs(const std::vector<SlowCopy>& copies) {
  std::map<Index3, std::vector<int>> in_cell;
  for (int i = 0; i < static_cast<int>(copies.size()); ++i)
    in_cell[copies[i].cell].push_back(i);
  std::vector<std::pair<int, int>> pairs;
  for (int a = 0; a < static_cast<int>(copies.size()); ++a)
    for (int axis = 0; axis < 3; ++axis) {
      Index3 above = copies[a].cell;
      ++above[axis];
      for (const int b : in_cell[above])
        if (std::any_of(copies[a].nodes.begin(), copies[a].nodes.end(),
                        [&](const Index3& n) { return copies[b].nodes.contains(n); }))
          pairs.emplace_back(a, b);
    }
  return pairs;
}

/// Names spread over glued faces until nothing changes any more.
SlowComplex slow_complex(const Body& body) {
  SlowComplex slow{slow_copies(body), {}, {}};
  for (int i = 0; i < static_cast<int>(slow.copies.size()); ++i) {
    slow.instance.push_back({});
    for (int v = 0; v < 8; ++v)
      slow.instance[i][v] = 8 * i + v;
    slow.piece.push_back(i);
  }
  const auto pairs = glued_pairs(slow.copies);
  for (bool changed = true; changed;) {
    changed = false;
    const auto agree = [&](int& x, int& y) {
      changed |= x != y;
      x = y = std::min(x, y);
    };
    for (const auto& [a, b] : pairs) {
      agree(slow.piece[a], slow.piece[b]);
      for (int v = 0; v < 8; ++v)
        if (const Index3 node = vertex(slow.copies[a].cell, v); inside(slow.copies[b].cell, node))
          agree(slow.instance[a][v], slow.instance[b][local(slow.copies[b].cell, node)]);
    }
  }
  return slow;
}

/// True when two numberings name the same classes.
class SameClasses {
 public:
  bool add(const std::uint32_t a, const int b) {
    return to_b_.emplace(a, b).first->second == b && to_a_.emplace(b, a).first->second == a;
  }
  std::size_t size() const { return to_b_.size(); }

 private:
  std::map<std::uint32_t, int> to_b_;
  std::map<int, std::uint32_t> to_a_;
};

/// For each copy of the complex, the slow copy with the same cell and nodes.
std::vector<int> match_copies(const Body& body, const CellComplex& complex, const SlowComplex& slow) {
  std::map<std::pair<Index3, NodeSet>, int> by_content;
  for (int i = 0; i < static_cast<int>(slow.copies.size()); ++i)
    by_content[{slow.copies[i].cell, slow.copies[i].nodes}] = i;
  std::vector<int> match;
  for (const Copy& copy : complex.copies) {
    const Index3 cell = body.grid.index(body.grid.nodes(copy.cell)[0]);
    NodeSet nodes;
    for (int v = 0; v < 8; ++v)
      if (copy.nodes >> v & 1)
        nodes.insert(vertex(cell, v));
    const auto found = by_content.find({cell, nodes});
    match.push_back(found == by_content.end() ? -1 : found->second);
  }
  return match;
}

void expect_matches_slow(const Body& body, const CellComplex& complex) {
  const SlowComplex slow = slow_complex(body);
  ASSERT_EQ(complex.n_copies(), slow.copies.size());
  const auto match = match_copies(body, complex, slow);
  const Pieces all = pieces(complex);
  SameClasses corners, same_pieces;
  for (const auto c : ids<CopyId>(complex.n_copies())) {
    ASSERT_GE(match[c.value], 0) << "no such component";
    for (int v = 0; v < 8; ++v)
      ASSERT_TRUE(corners.add(complex.copies[c].corners[v].value, slow.instance[match[c.value]][v]));
    ASSERT_TRUE(same_pieces.add(all.piece[c], slow.piece[match[c.value]]));
  }
  EXPECT_EQ(corners.size(), complex.n_corners());
  EXPECT_EQ(same_pieces.size(), all.n_pieces);
}

/// Invariant 2, and that every table says the same thing.
void expect_consistent(const Body& body, const CellComplex& complex) {
  std::vector<std::set<CornerId>> holders(body.grid.n_nodes());
  ASSERT_EQ(complex.first_copy.size(), body.grid.n_cells());
  for (const auto c : ids<CopyId>(complex.n_copies())) {
    const Copy& copy = complex.copies[c];
    bool is_listed = false;
    for (const CopyId other : complex.copies_of(copy.cell))
      is_listed |= other == c;
    ASSERT_TRUE(is_listed);
    for (int v = 0; v < 8; ++v) {
      const NodeId node = body.grid.nodes(copy.cell)[v];
      ASSERT_EQ(complex.node[copy.corners[v]], node);
      if (copy.nodes >> v & 1) {
        holders[node.value].insert(copy.corners[v]);
        ASSERT_EQ(complex.copy_at(copy.cell, v), c);
      } else if (!body.grid.is_material(node)) {
        ASSERT_FALSE(complex.copy_at(copy.cell, v).valid());
      }
    }
  }
  for (const auto n : ids<NodeId>(body.grid.n_nodes())) {
    ASSERT_EQ(holders[n.value].size(), body.grid.is_material(n) ? 1u : 0u);
    ASSERT_EQ(complex.real_corner[n], holders[n.value].empty() ? CornerId() : *holders[n.value].begin());
  }
}

/// A piece is exactly a component of the material nodes over uncut edges: the eight cells around a material node all
/// exist, any two that share a face are glued there, and glued copies share a material node.
void expect_pieces_of_nodes(const Body& body, const CellComplex& complex) {
  std::set<Index3> seen;
  const Pieces all = pieces(complex);
  std::set<std::uint32_t> seen_pieces;
  for (const auto n : ids<NodeId>(body.grid.n_nodes())) {
    if (!body.grid.is_material(n) || seen.contains(body.grid.index(n)))
      continue;
    const NodeSet component = flood(body, body.grid.index(n), [](const Index3&) { return true; });
    seen.insert(component.begin(), component.end());
    std::set<std::uint32_t> of_component;
    for (const auto c : ids<CopyId>(complex.n_copies()))
      for (int v = 0; v < 8; ++v)
        if ((complex.copies[c].nodes >> v & 1) &&
            component.contains(body.grid.index(body.grid.nodes(complex.copies[c].cell)[v])))
          of_component.insert(all.piece[c]);
    ASSERT_EQ(of_component.size(), 1u);
    ASSERT_TRUE(seen_pieces.insert(*of_component.begin()).second) << "two components in one piece";
  }
  EXPECT_EQ(seen_pieces.size(), all.n_pieces);
}

/// Built again, and up to names after an update.
void expect_same(const CellComplex& a, const CellComplex& b) { ASSERT_TRUE(support::renaming(a, b).has_value()); }

/// One parent a corner, an instance of the same node, whichever copy is asked; real stays real; pieces only split; what
/// is not named as changed has not.
void expect_change(const CellComplex& before, const CellComplex& after, const ComplexChange& change) {
  ASSERT_EQ(change.n_copies_before, before.n_copies());
  ASSERT_EQ(change.n_corners_before, before.n_corners());
  ASSERT_EQ(change.parents.size(), after.n_corners() - before.n_corners());
  const auto parent = [&](const CornerId corner) {
    return corner.value < before.n_corners() ? corner : change.parents[corner.value - before.n_corners()];
  };
  for (const auto corner : ids<CornerId>(after.n_corners())) {
    ASSERT_LT(parent(corner).value, before.n_corners());
    ASSERT_EQ(before.node[parent(corner)], after.node[corner]);
  }
  ASSERT_TRUE(std::is_sorted(change.copies.begin(), change.copies.end()));
  ASSERT_EQ(std::adjacent_find(change.copies.begin(), change.copies.end()), change.copies.end()) << "named twice";
  const Pieces pieces_before = pieces(before), pieces_after = pieces(after);
  std::map<std::uint32_t, std::uint32_t> piece_before;
  for (const auto c : ids<CopyId>(after.n_copies())) {
    const Copy& copy = after.copies[c];
    const bool same =
      c.value < before.n_copies() && before.copies[c].nodes == copy.nodes && before.copies[c].corners == copy.corners;
    ASSERT_NE(same, std::binary_search(change.copies.begin(), change.copies.end(), c));
    for (int v = 0; v < 8; ++v)
      if (copy.nodes >> v & 1) {
        const CopyId from = before.copy_at(copy.cell, v);
        ASSERT_EQ(copy.nodes & ~before.copies[from].nodes, 0) << "cuts join nothing";
        for (int w = 0; w < 8; ++w)
          ASSERT_EQ(parent(copy.corners[w]), before.copies[from].corners[w]);
        const std::uint32_t piece = pieces_before.piece[from];
        ASSERT_EQ(piece_before.emplace(pieces_after.piece[c], piece).first->second, piece);
      }
  }
  ASSERT_EQ(after.real_corner.items(), before.real_corner.items()) << "a real corner keeps its name";
}

/// Adds cuts in a random order and in random steps; after each of them, updated is built.
void expect_updates(Random& random, Body body, std::vector<EdgeCut> cuts, const std::size_t n_steps) {
  std::shuffle(cuts.begin(), cuts.end(), random);
  CellComplex complex = build_complex(body.grid, body.cuts);
  for (std::size_t step = 0; step < n_steps; ++step) {
    std::vector<EdgeId> edges;
    for (std::size_t i = step * cuts.size() / n_steps; i < (step + 1) * cuts.size() / n_steps; ++i) {
      body.cuts.add(cuts[i]);
      edges.push_back(cuts[i].edge);
    }
    const CellComplex before = complex;
    const ComplexChange change = update_complex(body.grid, body.cuts, edges, complex);
    expect_change(before, complex, change);
    expect_same(complex, build_complex(body.grid, body.cuts));
    if (testing::Test::HasFatalFailure())
      return;
  }
}

Body cut_at_once(Body body, const std::vector<EdgeCut>& cuts) {
  for (const EdgeCut& cut : cuts)
    body.cuts.add(cut);
  return body;
}

void check(Random& random, const Body& body, const std::vector<EdgeCut>& cuts) {
  const Body cut = cut_at_once(body, cuts);
  const CellComplex complex = build_complex(cut.grid, cut.cuts);
  expect_consistent(cut, complex);
  expect_matches_slow(cut, complex);
  expect_pieces_of_nodes(cut, complex);
  const std::size_t n_steps = 1 + random() % std::max<std::size_t>(1, std::min<std::size_t>(6, cuts.size()));
  expect_updates(random, body, cuts, n_steps);
}

TEST(Complex, OfAnUncutBodyIsItsGrid) {
  for (const Index3& n : {Index3{1, 1, 1}, {2, 3, 4}, {1, 5, 2}}) {
    const Body body = support::block(n, 0.5);
    const CellComplex complex = build_complex(body.grid, body.cuts);
    EXPECT_EQ(complex.n_copies(), body.grid.n_cells());
    EXPECT_EQ(complex.n_corners(), body.grid.n_nodes());
    EXPECT_EQ(grid::n_pieces(complex), 1u);
    const Points x = rest_positions(body.grid, complex);
    for (const auto corner : ids<CornerId>(complex.n_corners()))
      EXPECT_EQ(x[corner.value], body.grid.position(complex.node[corner]));
    expect_consistent(body, complex);
  }
}

TEST(Complex, HasTwoCopiesAtTheFaceOfAFront) {
  // Four nodes in a ring, its lower x edge cut: the cell through the ring holds one component, the one below it two.
  Body body = support::block({2, 1, 2});
  body.cuts.add({*body.grid.find_edge({1, 1, 1}, 0), 0.5, Vec3::UnitX(), 1});
  const CellComplex complex = build_complex(body.grid, body.cuts);
  const CellId below = *body.grid.find_cell({1, 1, 0}), above = *body.grid.find_cell({1, 1, 1});
  EXPECT_TRUE(complex.copies[complex.first_copy[below]].next.valid());
  EXPECT_FALSE(complex.copies[complex.first_copy[above]].next.valid());
  EXPECT_EQ(grid::n_pieces(complex), 1u);
  const CornerId left = complex.real_corner[*body.grid.find_node({1, 1, 1})];
  const Copy& joined = complex.copies[complex.copy_at(above, 0)];
  EXPECT_EQ(joined.corners[0], left);
  EXPECT_EQ(complex.copies[complex.copy_at(below, 4)].corners[5], joined.corners[1]) << "glued along the whole face";
  EXPECT_EQ(complex.copies[complex.copy_at(below, 5)].corners[4], joined.corners[0]) << "glued along the whole face";
  EXPECT_NE(complex.copies[complex.copy_at(below, 4)].corners[1], complex.copies[complex.copy_at(below, 5)].corners[1]);
}

TEST(Complex, AgreesWithItsDefinitionOnRandomCutSets) {
  Random random(4);
  std::size_t n_cut_sets = 0, n_pieces = 0;
  for (int i = 0; i < 300; ++i) {
    const Index3 n = {2 + i % 4, 1 + i / 4 % 4, 1 + i / 16 % 4};
    auto nodes = i % 2 == 0 ? support::block_nodes(n) : support::some_nodes(random, n, 0.7);
    if (nodes.empty())
      nodes = {{1, 1, 1}};
    const Body body = support::make_body({}, nodes, support::midway);
    const auto cuts = support::random_cuts(random, body, support::uniform(random, 0.02, 0.98));
    check(random, body, cuts);
    ASSERT_FALSE(HasFatalFailure()) << "random set " << i;
    n_cut_sets += cuts.empty() ? 0 : 1;
    n_pieces += grid::n_pieces(build_complex(body.grid, cut_at_once(body, cuts).cuts));
  }
  EXPECT_GT(n_cut_sets, 250u);
  EXPECT_GT(n_pieces, 1500u) << "the sets are too tame";
}

TEST(Complex, AgreesWithItsDefinitionOnEmbeddedBodies) {
  Random random(5);
  const std::string liver = std::string(KERF_SOURCE_DIR) + "/params/meshes/liver_25k.off";
  for (const auto& [mesh, h] : {std::pair(geometry::sphere_mesh(1, Vec3::Zero(), 3), 0.3),
                                std::pair(geometry::require_solid(geometry::read_mesh(liver, 1e-3), liver), 0.022)}) {
    const cut::Embedding e = cut::embed(mesh, h, {0.1, 0.5, 0.7});
    const Body body{e.grid, e.cuts};
    for (const double probability : {0.0, 0.1, 0.5, 0.9})
      check(random, body, support::random_cuts(random, body, probability));
    const support::Plane plane{Vec3(1, 0.3, -0.2).normalized(), 0.12};
    check(random, body, support::plane_cuts(body, plane));
    ASSERT_FALSE(HasFatalFailure());
  }
}

} // namespace
} // namespace kerf::grid
