#include "cut/add_cuts.h"

#include "cut/at_skin.h"

namespace kerf::cut {

std::vector<grid::EdgeId> add_cuts(const grid::Grid& grid, grid::Cuts& cuts, const grid::CellComplex& complex,
                                   const Points& x, const std::span<const grid::EdgeCut> found, const Front front) {
  std::vector<grid::EdgeId> edges;
  for (const bool of_skin : {false, true}) // whether a cut of the skin goes on depends on those below it
    for (const grid::EdgeCut& cut : found) {
      if (cuts.is_cut(cut.edge) != of_skin || !cuts.can_be_cut(grid, cut.edge))
        continue;
      if (of_skin && front == Front::possible && !goes_on(grid, cuts, complex, x, cut))
        continue;
      cuts.add(grid, cut);
      edges.push_back(cut.edge);
    }
  if (front == Front::none) {
    part_skin(grid, cuts, edges);
    return edges;
  }
  const auto more = end_at_skin(grid, cuts, complex, x, edges);
  edges.insert(edges.end(), more.begin(), more.end());
  return edges;
}

} // namespace kerf::cut
