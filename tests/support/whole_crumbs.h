#pragma once

#include "grid/complex.h"
#include "grid/material.h"
#include "grid/solid.h"

#include <algorithm>
#include <bit>
#include <map>
#include <vector>

namespace kerf::support {

/// What is glued is a crumb together, or none of it is; corners likewise.
inline bool are_crumbs_whole_pieces(const grid::Solid& solid) {
  const grid::Pieces pieces = grid::pieces(solid.complex);
  std::map<std::uint32_t, std::uint32_t> crumb_of;
  for (const auto c : ids<grid::CopyId>(solid.complex.n_copies())) {
    const grid::Copy& copy = solid.complex.copies[c];
    if (copy.is_lapsed())
      continue;
    const std::uint32_t crumb = solid.crumbs.of(c);
    if (crumb_of.try_emplace(pieces.piece[c], crumb).first->second != crumb)
      return false;
    const auto agrees = [&](const grid::CornerId k) { return solid.crumbs.holds(k) == solid.crumbs.holds(c); };
    if (!std::ranges::all_of(copy.corners, agrees))
      return false;
  }
  return true;
}

/// No piece of loose copies alone is missing among the crumbs.
inline bool are_loose_pieces_crumbs(const grid::Solid& solid) {
  const grid::Pieces pieces = grid::pieces(solid.complex);
  std::vector<bool> is_loose(pieces.n_pieces, true);
  for (const auto c : ids<grid::CopyId>(solid.complex.n_copies()))
    if (const grid::Copy& copy = solid.complex.copies[c];
        !copy.is_lapsed() && is_loose[pieces.piece[c]] && std::popcount(copy.nodes) > 1)
      is_loose[pieces.piece[c]] = grid::fill(solid, copy) < grid::well_filled;
  for (const auto c : ids<grid::CopyId>(solid.complex.n_copies()))
    if (!solid.complex.copies[c].is_lapsed() && is_loose[pieces.piece[c]] && !solid.crumbs.holds(c))
      return false;
  return true;
}

} // namespace kerf::support
