#pragma once

/// Nodes for copies that have none. A blade that passes between the last node and the skin cuts off skin alone;
/// where they have a cell to themselves, they are a copy without a node. Models whose particles are nodes let it
/// follow one.

#include "grid/solid.h"

namespace kerf::grid {

struct Followed {
  CopyId copy; ///< one without nodes
  NodeId node;
};

/// For each copy without nodes, ascending: the lowest node of the nearest copies (fewest steps between copies with a
/// corner in common) that hang together with it; for all of a piece of skin alone, the lowest node below one of
/// its points. So it does not depend on the order of cuts.
std::vector<Followed> followed_nodes(const Solid& solid);

} // namespace kerf::grid
