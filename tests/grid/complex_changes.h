#pragma once

/// What a cut says that it has changed of a complex, against the complexes before and after.

#include "tests/grid/complex_checks.h"
#include "tests/grid/histories.h"

#include <algorithm>

namespace kerf::grid {

using histories::Plan;
using support::Random;
using support::uniform;

/// The copy in which one item of a copy was: a point of the skin that had not been told of, with the node under it.
inline CopyId copy_before(const Body& body, const CellComplex& before, const CellId cell, const int item) {
  const CopyId c = before.copy_with(cell, item);
  return c.valid() ? c : before.copy_at(cell, skeleton_of(material_of(body.grid, cell)).vertex[item]);
}
inline CopyId copy_before(const Body& body, const CellComplex& before, const Copy& copy) {
  return copy_before(body, before, copy.cell, std::countr_zero(copy.items()));
}

/// One parent a corner, an instance of the same node, whichever copy is asked; real stays real; pieces only split; what
/// is not named as changed has not.
inline void expect_change(const Body& body, const CellComplex& before, const CellComplex& after,
                          const CutChange& change) {
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
  ASSERT_TRUE(std::is_sorted(change.reshaped.begin(), change.reshaped.end()));
  ASSERT_EQ(std::adjacent_find(change.copies.begin(), change.copies.end()), change.copies.end()) << "named twice";
  const Pieces pieces_before = pieces(before), pieces_after = pieces(after);
  std::set<CopyId> divided;
  for (const auto c : ids<CopyId>(after.n_copies()))
    if (const CopyId from = copy_before(body, before, after.copies[c]); from != c)
      divided.insert(from);
  std::map<std::uint32_t, std::uint32_t> piece_before;
  for (const auto c : ids<CopyId>(after.n_copies())) {
    const Copy& copy = after.copies[c];
    const bool same = c.value < before.n_copies() && before.copies[c].nodes == copy.nodes &&
                      before.copies[c].skin == copy.skin && before.copies[c].corners == copy.corners &&
                      !divided.contains(c);
    ASSERT_NE(same, std::binary_search(change.copies.begin(), change.copies.end(), c));
    const CopyId from = copy_before(body, before, copy);
    ASSERT_TRUE(from.valid());
    for (int item = 0; item < skeleton::n_items; ++item)
      if (copy.items() >> item & 1) {
        ASSERT_EQ(copy_before(body, before, copy.cell, item), from) << "cuts join nothing";
      }
    for (int v = 0; v < 8; ++v)
      ASSERT_EQ(parent(copy.corners[v]), before.copies[from].corners[v]);
    const std::uint32_t piece = pieces_before.piece[from];
    ASSERT_EQ(piece_before.emplace(pieces_after.piece[c], piece).first->second, piece);
  }
  ASSERT_EQ(after.real_corner.items(), before.real_corner.items()) << "a real corner keeps its name";
}

/// The change names what was cut, the cells that it is cut in, and their copies as those of another shape.
inline void expect_reshaped(const Body& body, const histories::Step& step, const CutChange& change) {
  ASSERT_EQ(change.edges, step.edges());
  ASSERT_EQ(change.segments, step.segments());
  std::set<CellId> cells;
  for (const auto c : ids<CellId>(body.grid.n_cells())) {
    const auto edges = body.grid.edges(c);
    const auto faces = body.grid.faces(c);
    for (const EdgeCut& cut : step.cuts)
      if (std::ranges::find(edges, cut.edge) != edges.end())
        cells.insert(c);
    for (const auto& [segment, t, normal, label, aside] : step.of_skin)
      if (segment.face.valid() ? std::ranges::find(faces, segment.face) != faces.end() : segment.cell == c)
        cells.insert(c);
  }
  ASSERT_EQ(change.cells, std::vector<CellId>(cells.begin(), cells.end()));
  std::set<CopyId> copies(change.copies.begin(), change.copies.end());
  for (const auto c : ids<CopyId>(body.complex.n_copies()))
    if (cells.contains(body.complex.copies[c].cell))
      copies.insert(c);
  ASSERT_EQ(change.reshaped, std::vector<CopyId>(copies.begin(), copies.end()));
}

/// Follows a plan in a random order and in random steps; after each of them, updated is built.
inline void expect_updates(Random& random, Body body, const Plan& plan, const std::size_t n_steps) {
  body.complex = build_complex(body);
  for (const histories::Step& step : histories::dealt(random, plan, n_steps)) {
    histories::apply(step, body);
    const CellComplex before = body.complex;
    const CutChange change = update_complex(body, step.edges(), step.segments());
    expect_change(body, before, body.complex, change);
    expect_consistent(body, body.complex);
    expect_same(body.complex, build_complex(body));
    expect_reshaped(body, step, change);
    if (testing::Test::HasFatalFailure())
      return;
  }
}

} // namespace kerf::grid
