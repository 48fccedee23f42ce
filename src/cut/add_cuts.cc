#include "cut/add_cuts.h"

#include "cut/at_skin.h"

namespace kerf::cut {

AddedCuts add_cuts(grid::Solid& solid, const Points& x, const std::span<const grid::EdgeCut> found, const Front front) {
  AddedCuts added;
  std::vector<grid::EdgeId>& edges = added.edges;
  const auto add = [&](const grid::EdgeCut& cut) {
    if (!solid.cuts.can_be_cut(solid.grid, cut.edge))
      return;
    solid.cuts.add(solid.grid, cut);
    edges.push_back(cut.edge);
  };
  std::vector<grid::EdgeCut> of_skin; // whether they go on depends on those below
  for (const grid::EdgeCut& cut : found)
    if (front == Front::possible && solid.cuts.is_cut(cut.edge) && solid.cuts.can_be_cut(solid.grid, cut.edge))
      of_skin.push_back(cut);
    else
      add(cut);
  if (front == Front::none) {
    part_skin(solid, edges);
    return added;
  }
  for (bool any = true; any;) { // and on each other, whatever their order
    const auto go_on = cuts_that_go_on(solid, x, edges, of_skin);
    any = !go_on.empty();
    for (const grid::EdgeCut& cut : go_on)
      add(cut);
    std::erase_if(of_skin, [&](const grid::EdgeCut& cut) { return solid.cuts.is_cut_twice(cut.edge); });
  }
  added.n_tips = of_skin.size();
  const auto more = end_at_skin(solid, x, edges);
  edges.insert(edges.end(), more.begin(), more.end());
  return added;
}

} // namespace kerf::cut
