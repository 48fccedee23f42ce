#pragma once

/// Where the edges and cells of a body are now, block by block, so that whoever cuts looks at those nearby alone.
///
/// Method: the material nodes in bricks of 4 x 4 x 4, in Morton order; an edge belongs to the brick of its lower node,
/// a cell to that of its lowest material node. A brick's box holds the real corners of its nodes and of the upper ends
/// of its edges; eight boxes make the box above them, up to one. Real corners keep their names for the life of a body,
/// so lists of them are made once, of rows that follow each other in memory. fit() goes through the rows in that order
/// and not block by block: then the memory sees what comes next.
///
/// Limit: where a brick's pieces have come apart, its box reaches from one to the other.

#include "geometry/box_tree.h"
#include "grid/solid.h"

#include <algorithm>
#include <functional>

namespace kerf::cut {

class EdgeBoxes {
 public:
  /// What is known of some edges between material nodes, current configuration.
  struct Block {
    Box box;            ///< holds them, if the body moves before and now [m]
    double longest = 0; ///< of them, now [m]

    /// Other corners of the block's cells may lie beside the ends of edges.
    Box around_cells() const {
      const Vec3 slack = Vec3::Constant(2 * longest);
      return {box.lower - slack, box.upper + slack};
    }
  };

  EdgeBoxes(const grid::Solid& solid);

  /// For corners that stand at `x` [m]. Throws NumericalError when one is not at a finite position.
  void fit(const Points& x) { fit(x, x); }
  /// For corners that have moved from `x_before` to `x` [m].
  void fit(const Points& x_before, const Points& x);
  /// The same where `x_before` is what it was fitted to last, but for corners that are new: these positions are not
  /// read once more.
  void move_on(const Points& x_before, const Points& x);

  /// Numbers of the blocks that `may_meet` does not turn down, ascending. It may not turn a block down unless all parts
  /// of the block would be.
  std::vector<std::uint32_t> blocks(const std::function<bool(const Block&)>& may_meet) const;

  /// Calls f(real corner of the lower node, of the upper node, axis) for each edge between material nodes in a block,
  /// cut or not.
  template <class Function>
  void for_each_edge(const std::uint32_t block, const Function& f) const {
    for (std::uint32_t i = starts_[block].row; i < starts_[block + 1].row; ++i) {
      const Row& row = rows_[rows_of_blocks_[i]];
      for (std::uint32_t k = 0; k < row.n; ++k) {
        const grid::CornerId lower(row.first + k);
        if (k + 1 < row.n)
          f(lower, grid::CornerId(lower.value + 1), 0);
        else if (row.x_end != none)
          f(lower, grid::CornerId(row.x_end), 0);
        if (row.upper[0] != none)
          f(lower, grid::CornerId(row.upper[0] + k), 1);
        if (row.upper[1] != none)
          f(lower, grid::CornerId(row.upper[1] + k), 2);
      }
    }
  }

  /// Calls f(cell) for each cell of a block.
  template <class Function>
  void for_each_cell(const std::uint32_t block, const Function& f) const {
    for (std::uint32_t i = starts_[block].cell; i < starts_[block + 1].cell; ++i)
      f(cells_[i]);
  }

  /// Calls f(edge, real corner of its material node) for each edge of the skin that begins in a block.
  template <class Function>
  void for_each_skin_edge(const std::uint32_t block, const Function& f) const {
    for (std::uint32_t i = starts_[block].skin; i < starts_[block + 1].skin; ++i)
      f(skin_[i].edge, skin_[i].corner);
  }

  /// Calls f(cell) for each cell of a block through which the skin passes.
  template <class Function>
  void for_each_skin_cell(const std::uint32_t block, const Function& f) const {
    for (std::uint32_t i = starts_[block].skin_cell; i < starts_[block + 1].skin_cell; ++i)
      f(skin_cells_[i]);
  }

  /// The block's box holds edges between material nodes; edges of the skin begin at one of those. How far they reach,
  /// to corners outside of the material, is not known: not farther than four times the longest edge of the body, now or
  /// at rest, as of one that is squashed they may stand out further than its edges [m].
  double reach_of_skin() const { return 4 * std::max(longest(), h_); }
  /// Holds all of a block: edges, edges of the skin, cells [m].
  Box with_skin(const Block& block) const {
    const Vec3 slack = Vec3::Constant(reach_of_skin());
    return {block.box.lower - slack, block.box.upper + slack};
  }
  /// Whether anything of the body may be in a box [m]. Allocates nothing where nothing is.
  bool may_be_in(const Box& box) const {
    return !blocks([&](const Block& block) { return geometry::overlap(with_skin(block), box); }).empty();
  }

  /// Whether a corner has moved between what the boxes were fitted to.
  bool moves() const { return moves_; }
  const Block& block(const std::uint32_t i) const { return levels_[0][i]; }
  /// The longest edge of all, now [m].
  double longest() const { return levels_.back().front().longest; }
  std::size_t n_blocks() const { return starts_.size() - 1; }
  /// Memory of all tables [B].
  std::size_t n_bytes() const;

 private:
  static constexpr std::uint32_t none = grid::CornerId::no_value;

  /// Nodes of a brick in a row along x whose real corners follow each other, and so do those of the upper ends of their
  /// edges along y, and along z.
  struct Row {
    std::uint32_t first;                ///< corner of the first node
    std::uint32_t x_end;                ///< of the upper end of the last one's edge along x; none without
    std::array<std::uint32_t, 2> upper; ///< of the upper ends along y, z of the first one's edges; none without
    std::uint32_t block;
    std::uint8_t n = 1;         ///< nodes
    std::array<bool, 2> leaves; ///< whether the upper ends along y, z belong to other bricks
  };

  /// Where a block's entries begin.
  struct Start {
    std::uint32_t row = 0, cell = 0, skin = 0, skin_cell = 0;
  };

  struct SkinEdge {
    grid::EdgeId edge;
    grid::CornerId corner;
  };

  /// Material nodes by block, and the block of each.
  struct Nodes {
    std::vector<grid::NodeId> all;
    std::vector<std::uint32_t> start; ///< n_blocks + 1
    Table<grid::NodeId, std::uint32_t> block;
  };
  static Nodes list_nodes(const grid::Grid& grid);
  void list_rows(const grid::Solid& solid, const Nodes& nodes);
  void list_cells(const grid::Grid& grid, const Nodes& nodes);
  void list_skin(const grid::Solid& solid, const Nodes& nodes);
  void sort_rows(const std::vector<std::uint32_t>& slabs);
  void take_in(const Points& x);
  template <class N>
  void take_in(const Row& row, N n, const Points& x);
  void join();
  void visit(std::size_t level, std::size_t i, const std::function<bool(const Block&)>& may_meet,
             std::vector<std::uint32_t>& found) const;

  std::vector<Start> starts_;                 // n_blocks + 1
  std::vector<Row> rows_;                     // by slab of bricks, the same along z, then by corner: as memory lies
  std::vector<std::uint32_t> slabs_;          // where they begin among the rows, and where the last one ends
  std::vector<std::uint32_t> rows_of_blocks_; // by block
  std::vector<grid::CellId> cells_;           // by block
  std::vector<grid::CellId> skin_cells_;      // by block
  std::vector<SkinEdge> skin_;                // by block
  bool moves_ = false;
  double h_;                               // edge of the cubes at rest [m]
  std::vector<Block> now_, before_;        // as the corners stand now, and as they stood before
  std::vector<std::vector<Block>> levels_; // the blocks, eights of them, ... one
};

/// Throws NumericalError when a corner is not at a finite position: exact predicates have no answer there.
void require_finite(const Points& x);

} // namespace kerf::cut
