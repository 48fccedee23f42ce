#pragma once

/// How the corners of a cut body follow its phyxels (thesis §2.6.1, (2.33)). A real corner sits at a material node a
/// and sees the phyxels of its kernel:
///
///     x(X) = sum_i w_ai (x_i + F_i (X - X_i)) / sum_i w_ai
///
/// at X = X_a, with X_i, x_i, F_i rest position, position and gradient of phyxel i. As a function of X this is an
/// affine motion; its linear part is the gradient at the corner. A virtual corner takes the motion of the real corner
/// of its copies that is the fewest edges away, the mean where there are several: the Taylor extrapolation of §2.4.4.
///
/// A node that sees no phyxel takes the one that the shortest way through copies leads to (reach.h). A piece that holds
/// no phyxel at all follows the one nearest to its nodes' mean, as one (limit: not as a body of its own).
///
/// Material nodes never change, so pairs of nodes and phyxels, and their sights, outlive every cut; the map is built
/// anew from them.

#include "base/sparse_rows.h"
#include "pba/neighbours.h"
#include "pba/region.h"

namespace kerf::pba {

/// Which phyxels may carry which material nodes.
struct NodePairs {
  std::vector<grid::NodeId> nodes; ///< the material ones, ascending: a row of the map each
  Points rest;                     ///< of the nodes [m]
  std::vector<Pair> pairs;         ///< (row, phyxel), ascending: all that are closer than the phyxel's support
  std::vector<double> support;     ///< of each pair [m]
};

NodePairs find_node_pairs(const grid::Grid& grid, const Phyxels& phyxels);

struct CornerMap {
  SparseRows<double> rows;                 ///< of phyxels; a row's values sum to 1
  std::vector<std::uint32_t> source_start; ///< by corner
  std::vector<std::uint32_t> source;       ///< rows whose mean motion a corner takes
  Points rest;                             ///< of the phyxels [m]
  Points corners;                          ///< rest positions of the corners [m]
  std::size_t n_blind = 0;                 ///< nodes that see no phyxel
  std::size_t n_orphans = 0;               ///< pieces that hold none

  void archive(Archive& a) { a(rows, source_start, source, rest, corners, n_blind, n_orphans); }
};

/// `copies`: the copy of each phyxel (copies_around()); `sights`: of each of pairs.pairs.
CornerMap build_corner_map(const grid::Solid& solid, const Phyxels& phyxels, std::span<const grid::CopyId> copies,
                           const NodePairs& pairs, std::span<const Sight> sights);

/// Positions of the corners [m] from positions [m] and gradients [1] of the phyxels.
void follow(const CornerMap& map, const Points& x, const std::vector<Mat3>& F, Points& corners);

/// The piece of each phyxel, and of each material node.
std::vector<std::uint32_t> phyxel_pieces(const grid::CellComplex& complex, std::span<const grid::CopyId> copies);
std::vector<std::uint32_t> node_pieces(const grid::CellComplex& complex, const NodePairs& pairs);

/// Leaves nothing of the pairs whose ends lie in different pieces (thesis §2.3.1), whatever a criterion has seen of the
/// cut so far.
void part(std::span<const Pair> pairs, std::span<const std::uint32_t> first_pieces,
          std::span<const std::uint32_t> second_pieces, std::span<Sight> sights);

} // namespace kerf::pba
