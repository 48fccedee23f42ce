#pragma once

/// Nodes for copies that have none. A blade that passes between the last node and the skin cuts off rinds (cuts.h);
/// where they have a cell to themselves, they are a copy without a node. Models whose particles are nodes let it
/// follow one.

#include "grid/solid.h"

namespace kerf::grid {

struct Followed {
  CopyId copy; ///< one without nodes
  NodeId node;
};

/// For each copy without nodes, ascending: the lowest node of the nearest copies (fewest steps between copies with a
/// corner in common) that hang together with it; for all of a piece of rinds alone, the lowest node from which one of
/// them was cut off. So it does not depend on the order of cuts.
std::vector<Followed> followed_nodes(const Solid& solid);

} // namespace kerf::grid
