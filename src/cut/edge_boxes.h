#pragma once

/// Where the edges and cells of a body are now, block by block, so that whoever cuts looks at those nearby alone.
///
/// Method: the material nodes in bricks of 4 x 4 x 4, in Morton order; an edge belongs to the brick of its lower node, a
/// cell to that of its lowest material node. A brick's box holds the real corners of its nodes and of the upper ends of
/// its edges; eight boxes make the box above them, up to one. Real corners keep their names for the life of a body, so
/// lists of them are made once; fit() streams through them when the corners have moved.
///
/// Limit: where a brick's pieces have come apart, its box reaches from one to the other.

#include "grid/complex.h"

#include <functional>

namespace kerf::cut {

class EdgeBoxes {
 public:
  /// What is known of some edges between material nodes, current configuration.
  struct Block {
    Box box;            ///< holds them, if the body moves before and now [m]
    double longest = 0; ///< of them, now [m]
  };

  EdgeBoxes(const grid::Grid& grid, const grid::CellComplex& complex);

  /// For corners that stand at `x` [m]. Throws NumericalError when one is not at a finite position.
  void fit(const Points& x) { fit(x, x); }
  /// For corners that have moved from `x_before` to `x` [m].
  void fit(const Points& x_before, const Points& x);

  /// Numbers of the blocks that `may_meet` does not turn down, ascending. It may not turn a block down unless all parts
  /// of the block would be.
  std::vector<std::uint32_t> blocks(const std::function<bool(const Block&)>& may_meet) const;

  /// Calls f(real corner of the lower node, of the upper node, axis) for each edge between material nodes in a block, cut
  /// or not.
  template <class Function>
  void for_each_edge(const std::uint32_t block, const Function& f) const {
    const Start &start = starts_[block], &end = starts_[block + 1];
    for (std::uint32_t i = start.node, k = start.corner; i < end.node; ++i, ++k)
      for (int axis = 0; axis < 3; ++axis)
        if (uppers_[i][axis] != no_upper)
          f(corners_[k], corners_[start.corner + uppers_[i][axis]], axis);
  }

  /// Calls f(cell) for each cell of a block.
  template <class Function>
  void for_each_cell(const std::uint32_t block, const Function& f) const {
    for (std::uint32_t i = starts_[block].cell; i < starts_[block + 1].cell; ++i)
      f(cells_[i]);
  }

  /// Whether a corner has moved between what the boxes were fitted to.
  bool moves() const { return moves_; }
  const Block& block(const std::uint32_t i) const { return levels_[0][i]; }
  std::size_t n_blocks() const { return starts_.size() - 1; }
  /// Memory of all tables [B].
  std::size_t n_bytes() const;

 private:
  /// Where a block's entries begin.
  struct Start {
    std::uint32_t corner = 0, node = 0, cell = 0;
  };
  static constexpr std::uint8_t no_upper = 0xff;

  /// Tables of nodes: the block they belong to, and their place among its corners.
  struct Places {
    Table<grid::NodeId, std::uint32_t> block;
    Table<grid::NodeId, std::uint8_t> corner;
  };
  Places list_nodes(const grid::Grid& grid, const grid::CellComplex& complex);
  void list_uppers(const grid::Grid& grid, const grid::CellComplex& complex, const Places& places);
  void list_cells(const grid::Grid& grid, const Places& places);
  Block fitted(std::uint32_t block, const Points& x_before, const Points& x) const;
  void visit(std::size_t level, std::size_t i, const std::function<bool(const Block&)>& may_meet,
             std::vector<std::uint32_t>& found) const;

  std::vector<Start> starts_;                       // n_blocks + 1
  std::vector<grid::CornerId> corners_;             // by block: of its own nodes, then of upper ends in other blocks
  std::vector<std::array<std::uint8_t, 3>> uppers_; // by block, its own nodes: the upper ends among its corners
  std::vector<grid::CellId> cells_;                 // by block
  bool moves_ = false;
  std::vector<std::vector<Block>> levels_; // the blocks, eights of them, ... one
};

/// Throws NumericalError when a corner is not at a finite position: exact predicates have no answer there.
void require_finite(const Points& x);

} // namespace kerf::cut
