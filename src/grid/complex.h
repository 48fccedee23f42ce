#pragma once

/// The cells, duplicated once per connected component (the virtual node algorithm of Molino, Bao and Fedkiw 2004, on
/// cubes; thesis §2.4.2). Two copies in face-adjacent cells that share a material node, or a rind (cuts.h), on the
/// common face are glued along the whole face. Corners are the node instances that come out of it, the unknowns of
/// every physics.
///
/// A cut splits copies, and a corner depends on the copies of the (up to eight) cells around its node alone. So an
/// update looks at the cells around the new cut edges and at the nodes of those that split; all that is there keeps its
/// name: a copy the part (parts.h) with its lowest vertex, or rind, a corner the class with the node's own material,
/// else the first one; what is new comes last. Names depend on the sequence of cuts, the complex up to names does not.

#include "grid/parts.h"

#include <span>

namespace kerf::grid {

using CopyId = Id<struct CopyTag>;
using CornerId = Id<struct CornerTag>;

struct Copy {
  CellId cell;
  std::uint8_t nodes = 0;          ///< bits of its material nodes; none where a blade has cut off rinds alone
  std::uint16_t rinds = 0;         ///< bits of its rinds, by the line of the cell
  std::array<CornerId, 8> corners; ///< in deal.II's vertex order
  CopyId next;                     ///< the cell's next copy, by its part (parts.h); invalid for the last

  Part part() const { return {nodes, rinds}; }
  void archive(Archive& a) { a(cell, nodes, rinds, corners, next); }
};

/// The copies of one cell: for (const CopyId c : complex.copies_of(cell)).
class CopiesOfCell {
 public:
  CopiesOfCell(const Table<CopyId, Copy>& copies, CopyId first) : copies_(copies), first_(first) {}

  struct iterator {
    const Table<CopyId, Copy>& copies;
    CopyId copy;
    CopyId operator*() const { return copy; }
    iterator& operator++() {
      copy = copies[copy].next;
      return *this;
    }
    bool operator!=(const iterator& other) const { return copy != other.copy; }
  };
  iterator begin() const { return {copies_, first_}; }
  iterator end() const { return {copies_, CopyId()}; }

 private:
  const Table<CopyId, Copy>& copies_;
  CopyId first_;
};

struct CellComplex {
  Table<CopyId, Copy> copies;
  Table<CellId, CopyId> first_copy;    ///< the copy with the cell's lowest material vertex
  Table<CornerId, NodeId> node;        ///< which node a corner is an instance of
  Table<NodeId, CornerId> real_corner; ///< the one corner that holds a material node; invalid for empty nodes

  std::size_t n_copies() const { return copies.size(); }
  std::size_t n_corners() const { return node.size(); }

  CopiesOfCell copies_of(CellId cell) const { return {copies, first_copy[cell]}; }
  /// The copy of `cell` whose component holds the material node at `vertex`; invalid when that node is empty.
  CopyId copy_at(CellId cell, int vertex) const;
  /// The copy of `cell` with the rind of `line`; invalid when there is none.
  CopyId copy_with_rind(CellId cell, int line) const;
  /// Memory of all tables [B].
  std::size_t n_bytes() const;
  void archive(Archive& a) { a(copies, first_copy, node, real_corner); }
};

/// Of what is cut. Copies are ordered by cell, then as their parts are (parts.h); corners by node.
CellComplex build_complex(const Solid& solid);

/// What a cut has done to a body. Placement, surface and physics follow it by this, and look for nothing themselves.
struct CutChange {
  std::vector<EdgeId> edges;  ///< that are cut now, and those cut before at faces whose skin is parted now
  std::vector<FaceId> parted; ///< faces whose skin is parted now; ascending
  std::vector<CellId> cells;  ///< around the edges; ascending
  std::size_t n_copies_before = 0, n_corners_before = 0;
  std::vector<CopyId> copies;    ///< new, or divided, or with other rinds or corners than before; ascending
  std::vector<CopyId> reshaped;  ///< these, and all whose material has another shape: those in the cells; ascending
  std::vector<CornerId> parents; ///< of the corners n_corners_before, ... in their order: where they came from

  /// Whether anything is cut.
  bool any() const { return !edges.empty(); }
};

/// Brings the complex up to date with edges that are cut, but were not when it was built or updated last (an edge may be
/// named again: where the skin of a face at it is now said to be parted). What it costs depends on the new edges
/// alone. Throws std::logic_error, and leaves the complex of no use, where the skin of a face now joins what was
/// parted.
CutChange update_complex(Solid& solid, std::vector<EdgeId> new_edges);

/// Appends for each new corner what its parent has.
template <class T>
void inherit(const CutChange& change, std::vector<T>& of_corners) {
  for (const CornerId parent : change.parents)
    of_corners.push_back(T(of_corners[parent.value]));
}

/// The connected components of the copies. Found from scratch whenever asked for, linear in the copies.
struct Pieces {
  Table<CopyId, std::uint32_t> piece; ///< of each copy, numbered from 0 in the order of their first copies
  std::uint32_t n_pieces = 0;
};
Pieces pieces(const CellComplex& complex);

/// How many pieces there are.
inline std::uint32_t n_pieces(const CellComplex& complex) { return pieces(complex).n_pieces; }

/// Rest positions of the corners [m].
Points rest_positions(const Solid& solid);

} // namespace kerf::grid
