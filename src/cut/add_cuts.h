#pragma once

/// Takes found cuts into a body: the edges, and what they do to its skin. The one way for blades and surfaces, whoever
/// cuts.

#include "grid/solid.h"

#include <span>
#include <vector>

namespace kerf::cut {

/// Whether cuts may end inside the body: those of blades may, those of a surface that passes through it do not.
enum class Front { none, possible };

struct AddedCuts {
  /// All at which something has changed: those that are cut, along with them too (end_at_skin()), and those cut before
  /// at faces whose skin is parted now.
  std::vector<grid::EdgeId> edges;
  std::size_t n_tips = 0; ///< of the skin, left whole (cuts_that_go_on())
};

/// Adds cuts that were found when the corners were at `x` [m], one a corner of `complex`, which does not know them yet;
/// without a front neither is asked for. What can be cut no more is left out, and so are tips of the skin
/// (cuts_that_go_on()).
AddedCuts add_cuts(grid::Solid& solid, const Points& x, std::span<const grid::EdgeCut> found, Front front);

} // namespace kerf::cut
