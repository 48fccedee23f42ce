#include "cut/add_cuts.h"

#include "cut/at_skin.h"

namespace kerf::cut {

AddedCuts add_cuts(const grid::Grid& grid, grid::Cuts& cuts, const grid::CellComplex& complex, const Points& x,
                   const std::span<const grid::EdgeCut> found, const Front front) {
  AddedCuts added;
  std::vector<grid::EdgeId>& edges = added.edges;
  const auto add = [&](const grid::EdgeCut& cut) {
    if (!cuts.can_be_cut(grid, cut.edge))
      return;
    cuts.add(grid, cut);
    edges.push_back(cut.edge);
  };
  std::vector<grid::EdgeCut> of_skin; // whether they go on depends on those below
  for (const grid::EdgeCut& cut : found)
    if (front == Front::possible && cuts.is_cut(cut.edge) && cuts.can_be_cut(grid, cut.edge))
      of_skin.push_back(cut);
    else
      add(cut);
  if (front == Front::none) {
    part_skin(grid, cuts, edges);
    return added;
  }
  for (bool any = true; any;) { // and on each other, whatever their order
    const auto go_on = cuts_that_go_on(grid, cuts, complex, x, edges, of_skin);
    any = !go_on.empty();
    for (const grid::EdgeCut& cut : go_on)
      add(cut);
    std::erase_if(of_skin, [&](const grid::EdgeCut& cut) { return cuts.is_cut_twice(cut.edge); });
  }
  added.n_tips = of_skin.size();
  const auto more = end_at_skin(grid, cuts, complex, x, edges);
  edges.insert(edges.end(), more.begin(), more.end());
  return added;
}

} // namespace kerf::cut
