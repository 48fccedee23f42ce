#pragma once

/// The cells, duplicated once per connected component (the virtual node algorithm of Molino, Bao and Fedkiw 2004, on
/// cubes; thesis §2.4.2). Two copies in face-adjacent cells that share a material node, a point of the skin, or an
/// interval between two cuts (parts.h) on the common face are glued along the whole face. Corners are the node
/// instances that come out of it, the unknowns of every physics.
///
/// A cut splits copies, and a corner depends on the copies of the (up to eight) cells around its node alone. So an
/// update looks at the cells around the new cut edges and at the nodes of those that split; all that is there keeps its
/// name: a copy the part (parts.h) with its lowest item, a corner the class with the node's own material,
/// else the first one; what is new comes last. Names depend on the sequence of cuts, the complex up to names does not.
///
/// Where a front is taken back (fronts.h), or parts turn out to lie on the same side of all cuts (Cuts::joined), copies
/// are joined again, and corners with them. Those whose names are not needed any more *lapse*: they stand in the
/// tables, but a lapsed copy holds nothing and belongs to no cell's copies, and no copy has a lapsed corner.

#include "base/loan.h"
#include "grid/parts.h"

#include <algorithm>
#include <span>

namespace kerf::grid {

using CopyId = Id<struct CopyTag>;
using CornerId = Id<struct CornerTag>;

struct Copy {
  CellId cell;
  std::uint8_t nodes = 0;          ///< bits of its material nodes; none where a blade has cut off skin alone
  std::uint32_t skin = 0;          ///< bits of its points of the skin, where blades have cut that (Part)
  std::array<CornerId, 8> corners; ///< in deal.II's vertex order
  CopyId next;                     ///< the cell's next copy, by its part (parts.h); invalid for the last
  Intervals intervals = 0;         ///< where cuts cross (Part)

  Part part() const { return {nodes, skin, intervals}; }
  Items items() const { return part().items(); }
  bool is_lapsed() const { return nodes == 0 && skin == 0; }
  void archive(Archive& a) { a(cell, nodes, skin, corners, next, intervals); }
};

/// Where its corners are [m].
inline std::array<Vec3, 8> corners_of(const Copy& copy, const Points& x) {
  std::array<Vec3, 8> corners;
  std::ranges::transform(copy.corners, corners.begin(), [&](const CornerId c) { return x[c.value]; });
  return corners;
}

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

/// A corner that no copy has any more, and the one at its node that took its place.
struct Lapse {
  CornerId corner, heir;
  void archive(Archive& a) { a(corner, heir); }
};

struct CellComplex {
  Table<CopyId, Copy> copies;
  Table<CellId, CopyId> first_copy;        ///< the copy with the cell's lowest material vertex
  Table<CornerId, NodeId> node;            ///< which node a corner is an instance of
  Table<NodeId, CornerId> real_corner;     ///< the one corner that holds a material node; invalid for empty nodes
  std::vector<std::array<CopyId, 2>> tied; ///< of one cell, held together ahead of a front (fronts.h)
  std::vector<Lapse> lapsed;               ///< no heir is lapsed itself

  std::size_t n_copies() const { return copies.size(); }
  std::size_t n_corners() const { return node.size(); }

  CopiesOfCell copies_of(CellId cell) const { return {copies, first_copy[cell]}; }
  /// The copy of `cell` whose component holds the material node at `vertex`; invalid when that node is empty.
  CopyId copy_at(CellId cell, int vertex) const;
  /// The copy of `cell` with an item of its skeleton that is a node, or that it has said to hold; invalid when none
  /// does.
  CopyId copy_with(CellId cell, int item) const;
  /// Memory of all tables [B].
  std::size_t n_bytes() const;
  void archive(Archive& a) { a(copies, first_copy, node, real_corner, tied, lapsed); }
};

/// Of what is cut. Copies are ordered by cell, then as their parts are (parts.h); corners by node.
CellComplex build_complex(const Solid& solid);

/// What a cut has done to a body. Placement, surface and physics follow it by this, and look for nothing themselves;
/// but that placement adds cells beside these whose vertices it had to move (surface/unfold.h).
struct CutChange {
  std::vector<EdgeId> edges;         ///< that are cut now
  std::vector<SkinSegment> segments; ///< of the skin, that are cut now
  std::vector<CellId> cells; ///< around them, and whose fronts are new, have moved or are taken back; ascending
  std::size_t n_copies_before = 0, n_corners_before = 0;
  std::vector<CopyId> copies;    ///< new, or divided, or joined, or with other items or corners than before; ascending
  std::vector<CopyId> reshaped;  ///< these, and all whose material has another shape: those in the cells; ascending
  std::vector<CornerId> parents; ///< of the corners n_corners_before, ... in their order: where they came from
  std::vector<Lapse> lapsed;     ///< corners that lapse now

  /// Whether anything is cut.
  bool any() const { return !cells.empty(); }
};

/// Brings the complex up to date with edges and segments of the skin that are cut, but were not when it was built or
/// updated last, and with cells whose fronts or joined items are others since, or are taken back. What it costs depends
/// on these alone. Lapsed copies are marked like those of crumbs: no physics knows them.
CutChange update_complex(Solid& solid, std::vector<EdgeId> new_edges, std::vector<SkinSegment> new_segments = {},
                         std::span<const CellId> with_other_fronts = {});

/// Appends for each new corner what its parent has.
template <class T>
void inherit(const CutChange& change, std::vector<T>& of_corners) {
  if (const std::size_t n = of_corners.size() + change.parents.size(); n > of_corners.capacity())
    of_corners.reserve(with_slack(n));
  for (const CornerId parent : change.parents)
    of_corners.push_back(T(of_corners[parent.value]));
}

/// The connected components of the copies; tied ones are connected.
struct Pieces {
  Table<CopyId, std::uint32_t> piece; ///< of each copy, numbered from 0 in the order of their first copies
  std::uint32_t n_pieces = 0;
};
Pieces pieces(const CellComplex& complex);
/// Brings those of before a cut up to date. True: at the cost of what is around it; else, where something may have come
/// free or hangs together now, from scratch.
bool update_pieces(const Solid& solid, const CutChange& change, Pieces& pieces);

/// The piece of each corner.
std::vector<std::uint32_t> corner_pieces(const CellComplex& complex);
/// The same of pieces that are known.
std::vector<std::uint32_t> corner_pieces(const CellComplex& complex, const Pieces& all);

/// How many pieces there are.
inline std::uint32_t n_pieces(const CellComplex& complex) { return pieces(complex).n_pieces; }

/// Rest positions of the corners [m].
Points rest_positions(const Solid& solid);

} // namespace kerf::grid
