#include "fem/coarsening.h"

#include "base/parallel.h"
#include "tests/fem/bodies.h"

#include <gtest/gtest.h>

namespace kerf::fem::coarsening_test {
namespace {

CellsOfLevel cells_of(const Body& body) {
  CellsOfLevel cells;
  for (const grid::Copy& copy : body.complex.copies) {
    const bool is_used = !body.crumbs.holds(grid::CopyId(cells.place.size()));
    cells.place.push_back(body.grid.index(body.grid.nodes(copy.cell)[0]));
    for (const grid::CornerId corner : copy.corners)
      cells.corners.push_back(is_used ? corner.value : CellsOfLevel::unused);
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

/// Wherever copies part and join again, come and go, in one change or several: what is found from what there was before
/// is what is found anew.
TEST(Coarsening, AfterChangesIsThatOfCellsAnew) {
  Draw draw(98);
  Body body = make_block({23, 14, 10}, 0.1, draw, {0.4, 0.6});
  const grid::CellComplex whole = body.complex;
  std::vector<grid::EdgeId> edges;
  for (const auto e : inner_edges(body))
    if (draw(0, 1) < (body.grid.index(body.grid.ends(e)[0])[0] % 5 == 2 ? 0.9 : 0.1)) {
      body.cuts.add(body.grid, {e, 0.5, draw.vector().normalized(), 1});
      edges.push_back(e);
    }
  grid::update_complex(body, edges);
  const grid::CellComplex cut = body.complex;
  const std::size_t n = cut.n_copies();
  ASSERT_GT(n, whole.n_copies() + 100);
  for (std::size_t c = 0; c < n; ++c) {
    if (c < whole.n_copies())
      body.complex.copies[grid::CopyId(c)].corners = whole.copies[grid::CopyId(c)].corners;
    body.crumbs.set(grid::CopyId(c), c < whole.n_copies() ? 0 : 1);
  }
  Incidence incidence(body);
  Coarsening before = coarsened(cells_of(body));
  const grid::CornerNumbers all_corners;
  std::vector<std::uint32_t> changed_since, corners_since;
  std::size_t n_changed = 0;
  for (int step = 0; step < 60; ++step) {
    const auto centre = grid::CopyId(static_cast<std::size_t>(draw(0, double(n))));
    const Vec3 at = body.grid.origin(cut.copies[centre].cell);
    const double radius = draw(0.05, 0.5);
    std::vector<grid::CopyId> changed;
    for (const auto c : ids<grid::CopyId>(n))
      if ((body.grid.origin(cut.copies[c].cell) - at).norm() < radius) {
        changed.push_back(c);
        changed_since.push_back(c.value);
        if (c.value < whole.n_copies())
          body.complex.copies[c].corners = draw(0, 1) < 0.5 ? whole.copies[c].corners : cut.copies[c].corners;
        body.crumbs.set(c, draw(0, 1) < (c.value < whole.n_copies() ? 0.1 : 0.5) ? 1 : 0);
      }
    const auto corners = incidence.update(body, changed);
    corners_since.insert(corners_since.end(), corners.begin(), corners.end());
    if (step % 3 == 1)
      continue;
    const CellsOfLevel cells = cells_of(body);
    std::ranges::sort(changed_since);
    changed_since.erase(std::unique(changed_since.begin(), changed_since.end()), changed_since.end());
    const Coarsening anew = coarsened(cells),
                     now = coarsened(cells, before, {changed_since, corners_since, incidence, all_corners});
    ASSERT_EQ(now.parent, anew.parent) << step;
    ASSERT_EQ(now.octant, anew.octant) << step;
    ASSERT_EQ(now.children.all, anew.children.all) << step;
    ASSERT_EQ(now.children.begin, anew.children.begin) << step;
    ASSERT_EQ(now.coarse.place, anew.coarse.place) << step;
    ASSERT_EQ(now.coarse.corners, anew.coarse.corners) << step;
    ASSERT_EQ(now.coarse.n_corners, anew.coarse.n_corners) << step;
    ASSERT_EQ(weights_of(now, cells), weights_of(anew, cells)) << step;
    ASSERT_EQ(weights_by_copy(now), weights_by_copy(anew)) << step;
    n_changed += anew.parent != before.parent ? 1 : 0;
    before = now;
    changed_since.clear();
    corners_since.clear();
  }
  EXPECT_GT(n_changed, 20u);
}

} // namespace
} // namespace kerf::fem::coarsening_test
