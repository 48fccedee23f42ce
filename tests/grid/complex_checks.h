#pragma once

/// What holds of every complex of copies: its tables agree, and it is the slow one made from the definitions of
/// grid/complex.h.

#include "grid/complex.h"
#include "tests/grid/slow_complex.h"
#include "tests/support/bodies.h"
#include "tests/support/same.h"

#include <gtest/gtest.h>

#include <bit>
#include <map>
#include <set>

namespace kerf::grid {

using slow::SlowComplex;
using support::Body;

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

/// For each copy of the complex, the slow copy with the same cell and material.
inline std::vector<int> match_copies(const Body& body, const CellComplex& complex, const SlowComplex& slow) {
  std::map<std::pair<Index3, slow::Items>, int> by_content;
  for (int i = 0; i < static_cast<int>(slow.copies.size()); ++i)
    by_content[{slow.copies[i].cell, slow.copies[i].said}] = i;
  std::vector<int> match;
  for (const Copy& copy : complex.copies) {
    const Index3 cell = slow::lattice_cell(body.grid, copy.cell);
    const auto found = by_content.find({cell, slow::named(material_of(body.grid, copy.cell), copy.part(), cell)});
    match.push_back(found == by_content.end() ? -1 : found->second);
  }
  return match;
}

inline void expect_matches_slow(const Body& body, const CellComplex& complex) {
  const SlowComplex slow = slow::slow_complex(body);
  ASSERT_EQ(complex.n_copies(), slow.copies.size());
  const auto match = match_copies(body, complex, slow);
  const Pieces all = pieces(complex);
  SameClasses corners, same_pieces;
  for (const auto c : ids<CopyId>(complex.n_copies())) {
    ASSERT_GE(match[c.value], 0) << "no such part";
    for (int v = 0; v < 8; ++v)
      ASSERT_TRUE(corners.add(complex.copies[c].corners[v].value, slow.instance[match[c.value]][v]));
    ASSERT_TRUE(same_pieces.add(all.piece[c], slow.piece[match[c.value]]));
  }
  EXPECT_EQ(corners.size(), complex.n_corners());
  EXPECT_EQ(same_pieces.size(), all.n_pieces);
}

/// The copies of a cell are in the order of their parts, and each is found by its material.
inline void expect_listed(const Body& body, const CellComplex& complex, const CellId cell) {
  const CellCuts cuts = cuts_of(body, cell);
  std::array<CopyId, skeleton::n_items> of_item;
  int last = -1;
  for (const CopyId c : complex.copies_of(cell)) {
    const Copy& copy = complex.copies[c];
    ASSERT_EQ(copy.cell, cell);
    ASSERT_NE(copy.items(), 0u);
    const int rank = std::countr_zero(copy.items());
    ASSERT_LT(last, rank);
    last = rank;
    for (int item = 0; item < skeleton::n_items; ++item)
      if (copy.items() >> item & 1) {
        ASSERT_FALSE(of_item[item].valid()) << "in two copies";
        of_item[item] = c;
      }
  }
  for (int item = 0; item < skeleton::n_items; ++item) {
    const bool is_said = item < skeleton::first_on_line || cuts.is_cut_at_skin();
    ASSERT_EQ(of_item[item].valid(), is_said && (cuts.skeleton().items >> item & 1) != 0);
    ASSERT_EQ(complex.copy_with(cell, item), of_item[item]);
    if (item < skeleton::first_on_line) {
      ASSERT_EQ(complex.copy_at(cell, item), of_item[item]);
    }
  }
}

/// Invariant 2, and that every table says the same thing.
inline void expect_consistent(const Body& body, const CellComplex& complex) {
  std::vector<std::set<CornerId>> holders(body.grid.n_nodes());
  ASSERT_EQ(complex.first_copy.size(), body.grid.n_cells());
  std::size_t n_listed = 0;
  for (const auto cell : ids<CellId>(body.grid.n_cells())) {
    expect_listed(body, complex, cell);
    for (const CopyId c : complex.copies_of(cell)) {
      const Copy& copy = complex.copies[c];
      for (int v = 0; v < 8; ++v) {
        const NodeId node = body.grid.nodes(copy.cell)[v];
        ASSERT_EQ(complex.node[copy.corners[v]], node);
        if (copy.nodes >> v & 1)
          holders[node.value].insert(copy.corners[v]);
      }
      ++n_listed;
    }
  }
  ASSERT_EQ(n_listed, complex.n_copies());
  for (const auto n : ids<NodeId>(body.grid.n_nodes())) {
    ASSERT_EQ(holders[n.value].size(), body.grid.is_material(n) ? 1u : 0u);
    ASSERT_EQ(complex.real_corner[n], holders[n.value].empty() ? CornerId() : *holders[n.value].begin());
  }
}

/// A piece is exactly what uncut segments hold together, through the body, whatever its cells: the cells around an item
/// all exist, any two of them that share a face are glued there, and glued copies share an item.
inline void expect_pieces_of_material(const Body& body, const CellComplex& complex) {
  const Pieces all = pieces(complex);
  std::map<slow::Item, std::set<std::uint32_t>> pieces_at;
  for (const auto c : ids<CopyId>(complex.n_copies())) {
    const CellId cell = complex.copies[c].cell;
    for (const auto& item :
         slow::named(material_of(body.grid, cell), complex.copies[c].part(), slow::lattice_cell(body.grid, cell)))
      pieces_at[item].insert(all.piece[c]);
  }
  std::set<std::uint32_t> seen;
  for (const slow::Items& items : slow::pieces_of(body)) {
    std::set<std::uint32_t> of_items;
    for (const auto& item : items)
      of_items.insert(pieces_at[item].begin(), pieces_at[item].end());
    ASSERT_EQ(of_items.size(), 1u);
    ASSERT_TRUE(seen.insert(*of_items.begin()).second) << "two in one piece";
  }
  EXPECT_EQ(seen.size(), all.n_pieces);
}

/// Built again, and up to names after an update.
inline void expect_same(const CellComplex& a, const CellComplex& b) {
  ASSERT_TRUE(support::renaming(a, b).has_value());
}

} // namespace kerf::grid
