#pragma once

/// What hangs together through the copies of a body, where distances across space tell nothing: two fingers of a hand
/// are near each other, and so are the lips of a cut, which are joined by no more than what is left behind its front.
///
/// Each copy goes with the phyxel that it is nearest to (reach.h). Two phyxels whose copies are glued somewhere are a
/// **link**. The shortest links that join all phyxels of a piece are among these (Mehlhorn 1988, Information Processing
/// Letters 27, 125-128).

#include "grid/solid.h"
#include "pba/corners.h"

namespace kerf::pba {

struct Link {
  Pair pair;         ///< the lower phyxel first
  double length = 0; ///< of the shortest way through copies [m]
  double area = 0;   ///< of the ways' material, where each is narrowest [m^2]
};

/// The copies that a phyxel reaches, for each: from its own one over glued faces, within its support, by ways of two
/// faces more than in a full grid at most; ascending. What lies across a gap is near it and is not reached.
std::vector<std::vector<grid::CopyId>> reached_copies(const grid::Solid& solid, const Phyxels& phyxels,
                                                      std::span<const grid::CopyId> copies);

/// Keeps pairs of which one phyxel reaches the other.
Neighbours reached_neighbours(const Phyxels& phyxels, std::span<const grid::CopyId> copies,
                              std::span<const std::vector<grid::CopyId>> reached);
/// Keeps pairs whose phyxel reaches a copy that holds the node.
NodePairs reached_node_pairs(const grid::Solid& solid, const Phyxels& phyxels,
                             std::span<const std::vector<grid::CopyId>> reached);

/// `copies`: the copy of each phyxel (grid::copies_around()). In the order of their lengths, then of their pairs.
std::vector<Link> find_links(const grid::Solid& solid, const Points& rest, std::span<const grid::CopyId> copies);

} // namespace kerf::pba
