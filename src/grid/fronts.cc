#include "grid/fronts.h"

namespace kerf::grid {

namespace {

constexpr double opening = 0.12; // c

/// The corners that two copies of a cell do not share.
void add_pairs(const Copy& one, const Copy& other, std::vector<Tie>& ties) {
  for (int v = 0; v < cube::n_vertices; ++v)
    if (one.corners[v] != other.corners[v])
      ties.push_back({one.corners[v], other.corners[v], 0});
}

bool is_passed(const Solid& solid, const Front& front) {
  return front.passed == 1 || (front.ahead & ~cuts_of(solid, front.cell).blades) == 0;
}

} // namespace

std::vector<Tie> ties(const Solid& solid) {
  const auto& copies = solid.complex.copies;
  std::vector<Tie> ties;
  for (const Front& front : solid.cuts.fronts()) {
    if (is_passed(solid, front))
      continue;
    const std::size_t first = ties.size();
    for (const CopyId c : solid.complex.copies_of(front.cell))
      for (CopyId d = copies[c].next; d.valid(); d = copies[d].next)
        add_pairs(copies[c], copies[d], ties);
    const double length = opening * front.area / solid.grid.h() * (1 - front.passed) / front.passed;
    for (std::size_t i = first; i < ties.size(); ++i)
      ties[i].length = length / static_cast<double>(ties.size() - first);
  }
  return ties;
}

} // namespace kerf::grid
