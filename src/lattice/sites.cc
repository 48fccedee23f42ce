#include "lattice/sites.h"

#include "grid/parts.h"

namespace kerf::lattice {

namespace {

using grid::CopyId;

/// Copies of pieces without a node, ascending.
std::vector<CopyId> loose_copies(const grid::CellComplex& complex) {
  const grid::Pieces pieces = grid::pieces(complex);
  std::vector<std::uint8_t> has_node(pieces.n_pieces, 0);
  for (const auto c : ids<CopyId>(complex.n_copies()))
    if (complex.copies[c].nodes != 0)
      has_node[pieces.piece[c]] = 1;
  std::vector<CopyId> loose;
  for (const auto c : ids<CopyId>(complex.n_copies()))
    if (!has_node[pieces.piece[c]])
      loose.push_back(c);
  return loose;
}

std::vector<std::uint32_t> numbers_by_name(const std::size_t n_names, const std::size_t first, const auto& names) {
  std::vector<std::uint32_t> number(n_names, no_point);
  for (std::size_t i = 0; i < names.size(); ++i)
    number[names[i].value] = static_cast<std::uint32_t>(first + i);
  return number;
}

} // namespace

Sites sites_of(const grid::Solid& solid) {
  Sites sites;
  for (const auto n : ids<grid::NodeId>(solid.grid.n_nodes()))
    if (solid.grid.is_material(n))
      sites.nodes.push_back(n);
  sites.loose = loose_copies(solid.complex);
  return sites;
}

std::array<std::vector<std::uint32_t>, 3> steps_of(const grid::Solid& solid, const Sites& sites) {
  const auto& [grid, cuts, complex] = solid;
  std::array<std::vector<std::uint32_t>, 3> next;
  next.fill(std::vector<std::uint32_t>(sites.n_points(), no_point));
  const auto point_of = numbers_by_name(grid.n_nodes(), 0, sites.nodes);
  for (const auto e : ids<grid::EdgeId>(grid.n_edges()))
    if (const auto& [lower, upper] = grid.ends(e);
        !cuts.is_cut(e) && grid.is_material(lower) && grid.is_material(upper))
      next[grid.axis(e)][point_of[lower.value]] = point_of[upper.value];

  const auto loose_point = numbers_by_name(complex.n_copies(), sites.nodes.size(), sites.loose);
  std::vector<std::uint8_t> is_taken(3 * sites.n_points(), 0);
  for (const CopyId lower : sites.loose)
    for (int axis = 0; axis < 3; ++axis) {
      const grid::CellId above = grid.neighbour(complex.copies[lower].cell, 2 * axis + 1);
      if (!above.valid())
        continue;
      auto& step = next[axis][loose_point[lower.value]];
      for (const CopyId upper : complex.copies_of(above)) {
        const std::uint32_t point = loose_point[upper.value];
        if (step != no_point || point == no_point || is_taken[3 * point + axis] != 0 ||
            !grid::are_glued(complex.copies[lower].part(), complex.copies[upper].part(), axis))
          continue;
        step = point;
        is_taken[3 * point + axis] = 1;
      }
    }
  return next;
}

} // namespace kerf::lattice
