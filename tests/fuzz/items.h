#pragma once

/// What holds a body's material together, from the words of grid/parts.h and with nothing of its code. Items are
/// material nodes and rinds; uncut edges join nodes, and the skin of a face that is whole joins what lies under its two
/// ends.
///
/// The arcs of the skin do not depend on what blades cut: they are found once for a grid, by tests/grid/slow_parts.h.

#include "grid/solid.h"

#include <array>
#include <vector>

namespace kerf::fuzz {

/// How the skin passes through a face: from edge to edge, over a row of material nodes.
struct FaceArc {
  std::array<grid::EdgeId, 2> edges;
  std::array<grid::NodeId, 2> nodes; ///< the material ends of the edges
  std::vector<grid::EdgeId> inner;   ///< between the nodes of the row
};
using FaceArcs = Table<grid::FaceId, std::vector<FaceArc>>;

FaceArcs face_arcs(const grid::Grid& grid);

/// Names of items: nodes first, then rinds by their edges.
using Item = std::uint32_t;
using ItemLinks = std::vector<std::array<Item, 2>>;

class Items {
 public:
  /// All must outlive it.
  Items(const grid::Solid& solid, const FaceArcs& arcs) : solid_(solid), arcs_(arcs) {}

  std::size_t n_names() const { return solid_.grid.n_nodes() + solid_.grid.n_edges(); }
  Item node(const grid::NodeId n) const { return n.value; }
  Item rind(const grid::EdgeId e) const { return static_cast<Item>(solid_.grid.n_nodes()) + e.value; }
  /// Is there a rind on the edge?
  bool has_rind(const grid::EdgeId e) const { return solid_.cuts.is_cut_twice(e); }

  /// What lies under the skin at an end of its arc: the rind of the edge there, or its node.
  Item under(const FaceArc& arc, const int end) const {
    return has_rind(arc.edges[end]) ? rind(arc.edges[end]) : node(arc.nodes[end]);
  }
  bool is_whole(grid::FaceId face, const FaceArc& arc) const;

  /// Appends what an edge joins, what the skin of a face joins.
  void add_links(grid::EdgeId edge, ItemLinks& links) const;
  void add_links(grid::FaceId face, ItemLinks& links) const;

 private:
  const grid::Solid& solid_;
  const FaceArcs& arcs_;
};

} // namespace kerf::fuzz
