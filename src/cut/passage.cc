#include "cut/passage.h"

#include "grid/parts.h"

#include <algorithm>

namespace kerf::cut {

using grid::Solid;

NearSweep near_sweep(const Points& line) {
  std::vector<Patch> pieces;
  for (std::size_t i = 1; i < line.size(); ++i)
    pieces.push_back({line[i - 1], line[i], line[i], line[i - 1]});
  return NearSweep(std::move(pieces));
}

bool is_near(const NearSweep& near, const Solid& solid, const grid::CellId c, const Points& x, const double room) {
  for (const grid::CopyId copy : solid.complex.copies_of(c)) {
    const Box box = geometry::box_around(corners_of(solid.complex.copies[copy], x));
    if (near.may_be_in({box.lower - Vec3::Constant(room), box.upper + Vec3::Constant(room)}))
      return true;
  }
  return false;
}

Passage::Passage(const std::span<const StandingEdge> edges, const std::set<grid::CutLabel>& coming) {
  for (const StandingEdge& edge : edges) {
    const auto& [label, line, before] = edge;
    if (edge.rests() && !coming.contains(label))
      continue;
    edges_.push_back({label, near_sweep(line)});
  }
}

grid::Segments Passage::cuts_in(const Solid& solid, const grid::CellId c, const Points& x, const std::size_t n_labels,
                                std::set<LeftCell>& left) const {
  grid::Segments cuts = 0;
  for (grid::CutLabel label = 1; label <= n_labels; ++label) {
    const grid::Segments own = left.contains({c, label}) ? 0 : grid::cut_by(solid, c, label);
    if (own == 0)
      continue;
    if (holds(label, solid, c, x))
      cuts |= own;
    else
      left.insert({c, label});
  }
  return (grid::cuts_of(solid, c).blades & ~cuts) != 0 ? cuts : 0;
}

bool Passage::holds(const grid::CutLabel label, const Solid& solid, const grid::CellId c, const Points& x) const {
  return std::ranges::any_of(edges_, [&](const Edge& edge) {
    return edge.label == label && is_near(edge.near, solid, c, x, solid.grid.h());
  });
}

} // namespace kerf::cut
