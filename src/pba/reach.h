#pragma once

/// Which phyxel carries a node that sees none: found by going from copy to copy, through the nodes that they share.

#include "grid/complex.h"

#include <span>

namespace kerf::pba {

struct Reached {
  std::vector<std::uint32_t> phyxel; ///< of each blind row
  std::size_t n_orphans = 0;         ///< pieces that hold no phyxel
};

/// `nodes`, `rest`: the material nodes, row by row [m]; `phyxels` [m] lie in `copies`; `blind`: rows, ascending.
Reached reach(const grid::CellComplex& complex, std::span<const grid::NodeId> nodes, const Points& rest,
              const Points& phyxels, std::span<const grid::CopyId> copies, std::span<const std::uint32_t> blind);

} // namespace kerf::pba
