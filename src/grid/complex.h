#pragma once

/// The cells, duplicated once per connected component (the virtual node algorithm of Molino, Bao and Fedkiw
/// 2004, on cubes; thesis §2.4.2). Two copies in face-adjacent cells that share a material node on the common face are
/// glued along the whole face. Corners are the node instances that come out of it, the unknowns of every physics.

#include "grid/cuts.h"

namespace kerf::grid {

using CopyId = Id<struct CopyTag>;
using CornerId = Id<struct CornerTag>;

struct Copy {
  CellId cell;
  std::uint8_t nodes = 0;          ///< bits of the material nodes of its component
  std::array<CornerId, 8> corners; ///< in deal.II's vertex order
};

struct CellComplex {
  Table<CopyId, Copy> copies; ///< ordered by cell, then by lowest vertex
  Table<CellId, std::uint32_t>
    first_copy;                        ///< copies of cell c: first_copy[c] .. first_copy[c + 1]; n_cells + 1 entries
  Table<CornerId, NodeId> node;        ///< which node a corner is an instance of
  Table<NodeId, CornerId> real_corner; ///< the one corner that holds a material node; invalid for empty nodes
  Table<CopyId, std::uint32_t> piece;  ///< connected component of the copy graph, numbered from 0
  std::uint32_t n_pieces = 0;

  std::size_t n_copies() const { return copies.size(); }
  std::size_t n_corners() const { return node.size(); }

  /// The copy of `cell` whose component holds the material node at `vertex`; invalid when that node is empty.
  CopyId copy_at(CellId cell, int vertex) const;
};

CellComplex build_complex(const Grid& grid, const Cuts& cuts);

/// For each corner of `after`, the corner of `before` it came from. `after` must come from `before` by further cuts.
Table<CornerId, CornerId> parents(const CellComplex& before, const CellComplex& after);

/// Rest positions of the corners [m].
Points rest_positions(const Grid& grid, const CellComplex& complex);

} // namespace kerf::grid
