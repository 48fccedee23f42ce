#pragma once

/// The points of the lattice, by which regions of shape matching are made.
///
/// Each material node of the grid is one. A piece that a blade has cut off between the last nodes and the skin holds none
/// (rinds alone, grid/cuts.h): there each copy is a point, for its whole mass. So every piece has regions of its own, and
/// no region holds mass of two pieces: what is cut apart is not drawn together, however far it falls.

#include "grid/solid.h"

#include <array>
#include <vector>

namespace kerf::lattice {

struct Sites {
  std::vector<grid::NodeId> nodes; ///< ascending; the points 0, 1, ...
  std::vector<grid::CopyId> loose; ///< copies of pieces without a node, ascending; the points after those

  std::size_t n_points() const { return nodes.size() + loose.size(); }
};
Sites sites_of(const grid::Solid& solid);

constexpr std::uint32_t no_point = grid::NodeId::no_value;

/// For each axis and point the next point, one step up: from a node along an uncut edge, and from a loose copy through
/// the face to a copy that it is glued to there. No two points have the same next one.
std::array<std::vector<std::uint32_t>, 3> steps_of(const grid::Solid& solid, const Sites& sites);

} // namespace kerf::lattice
