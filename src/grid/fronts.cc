#include "grid/fronts.h"

#include "grid/material.h"

#include <algorithm>

namespace kerf::grid {

namespace {

constexpr double opening = 0.12; // c

/// The corners that two copies of a cell do not share.
void add_pairs(const Copy& one, const Copy& other, std::vector<Tie>& ties) {
  for (int v = 0; v < cube::n_vertices; ++v)
    if (one.corners[v] != other.corners[v])
      ties.push_back({one.corners[v], other.corners[v], 0});
}

/// Do cuts leave two copies of a cell in one part?
bool hang_together(const Parts& parts, const Copy& one, const Copy& other) {
  return std::any_of(parts.begin(), parts.end(), [&](const Part& part) {
    return (part.items() & one.items()) != 0 && (part.items() & other.items()) != 0;
  });
}

} // namespace

std::vector<std::array<CopyId, 2>> tied_copies(const Solid& solid, const CellComplex& complex,
                                               const std::span<const CellId> cells) {
  const auto& copies = complex.copies;
  std::vector<std::array<CopyId, 2>> tied;
  for (const CellId cell : cells) {
    if (!solid.cuts.front(cell))
      continue;
    const Parts parts = whole_parts_of(cuts_of(solid, cell));
    for (const CopyId c : complex.copies_of(cell))
      for (CopyId d = copies[c].next; d.valid(); d = copies[d].next)
        if (hang_together(parts, copies[c], copies[d]))
          tied.push_back({c, d});
  }
  return tied;
}

std::vector<Tie> ties(const Solid& solid) {
  const auto& copies = solid.complex.copies;
  std::vector<Tie> ties;
  for (const auto& [c, d] : solid.complex.tied) {
    if (solid.crumbs.holds(c))
      continue;
    const Front& front = *solid.cuts.front(copies[c].cell);
    const std::size_t first = ties.size();
    add_pairs(copies[c], copies[d], ties);
    const double length = copies[c].nodes == 0 || copies[d].nodes == 0
                            ? std::min(fill(solid, copies[c]), fill(solid, copies[d])) * solid.grid.h()
                            : opening * front.area / solid.grid.h() * (1 - front.passed) / front.passed;
    for (std::size_t i = first; i < ties.size(); ++i)
      ties[i].length = length / static_cast<double>(ties.size() - first);
  }
  return ties;
}

} // namespace kerf::grid
