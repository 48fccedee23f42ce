#pragma once

/// How phyxels and copies hang together through the material of a body.
///
/// A way leads from a phyxel's copy over glued faces, one cube's edge for each. So each copy has a phyxel that it is
/// nearest to (the graph Voronoi diagram: Erwig 2000, Networks 36, 156-163), and carries along with it the nodes that
/// see no phyxel.

#include "grid/solid.h"

#include <limits>
#include <span>

namespace kerf::pba {

constexpr std::uint32_t no_phyxel = Id<void>::no_value;

/// The shortest way from a phyxel to a copy.
struct Way {
  double length = std::numeric_limits<double>::infinity(); ///< to the middle of the copy's cube [m]
  std::uint32_t phyxel = no_phyxel;                        ///< none in a piece that holds none
  double narrowest = 1;                                    ///< part of their cubes that all copies on it fill [1]
};

/// To each copy of a body; `copies`: of each phyxel. Of equally long ways that of the first phyxel.
Table<grid::CopyId, Way> shortest_ways(const grid::Solid& solid, const Points& phyxels,
                                       std::span<const grid::CopyId> copies);

/// Calls f(other) for each copy that is glued to a copy, or tied to it ahead of a front.
template <class Function>
void for_each_glued(const grid::Solid& solid, grid::CopyId c, const Function& f);

struct Reached {
  std::vector<std::uint32_t> phyxel; ///< of each blind row
  std::size_t n_orphans = 0;         ///< pieces that hold no phyxel
};

/// Which phyxel carries a node that sees none. `nodes`, `rest`: the material nodes, row by row [m]; `phyxels` [m] lie
/// in `copies`; `blind`: rows, ascending.
Reached reach(const grid::Solid& solid, std::span<const grid::NodeId> nodes, const Points& rest, const Points& phyxels,
              std::span<const grid::CopyId> copies, std::span<const std::uint32_t> blind);

template <class Function>
void for_each_glued(const grid::Solid& solid, const grid::CopyId c, const Function& f) {
  const grid::CellComplex& complex = solid.complex;
  const grid::Part mine = complex.copies[c].part();
  for (int face = 0; face < 6; ++face) {
    const grid::CellId cell = solid.grid.neighbour(complex.copies[c].cell, face);
    if (!cell.valid())
      continue;
    for (const grid::CopyId other : complex.copies_of(cell)) {
      const grid::Part its = complex.copies[other].part();
      if (face % 2 == 1 ? are_glued(mine, its, face / 2) : are_glued(its, mine, face / 2))
        f(other);
    }
  }
  for (const auto& [a, b] : complex.tied)
    if (a == c || b == c)
      f(a == c ? b : a);
}

} // namespace kerf::pba
