#pragma once

/// The lattice of cubes around a body, stored only where there is material (thesis §2.4): every cell that touches a
/// material node, and those cells' nodes, edges and faces. Which nodes hold material never changes; which edges are cut
/// is kept beside it (cuts.h).
///
/// Notation: an edge or face is named by its lower node and its axis (the direction of the edge, the normal of the
/// face). All are numbered by axis, then by their lowest node's z, y, x; so along x numbers follow each other, and the
/// tables hold runs (rows.h): building takes time, and the grid memory, like the body's surface, but for one byte
/// a node.
/// Limit: at most 2^20 nodes along an axis, none with a negative coordinate.

#include "base/id.h"
#include "base/vec.h"
#include "grid/cube.h"
#include "grid/rows.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace kerf::grid {

using NodeId = Id<struct NodeTag>;
using EdgeId = Id<struct EdgeTag>;
using FaceId = Id<struct FaceTag>;
using CellId = Id<struct CellTag>;

/// Where the nodes are at rest: node (i, j, k) at origin + h (i, j, k) [m].
struct Lattice {
  Vec3 origin = Vec3::Zero();
  double h = 1; ///< cube edge [m]

  /// Always this one expression, so that predicates see one position per node.
  Vec3 position(const Index3& i) const { return {origin[0] + h * i[0], origin[1] + h * i[1], origin[2] + h * i[2]}; }
};

/// Material nodes (x, y, z) from x = first to x = last, both included.
struct NodeRun {
  int first, last, y, z;
};

class Grid {
 public:
  /// Builds the cells that touch the given material nodes (coordinates from 1; duplicates are ignored). Throws
  /// DataError when there are none, or too many along an axis.
  Grid(const Lattice& lattice, const std::vector<Index3>& material_nodes);
  /// The same from runs in the order of z, y, first x; they may meet and overlap. Throws std::logic_error for another
  /// order.
  static Grid from_runs(const Lattice& lattice, const std::vector<NodeRun>& material);

  const Lattice& lattice() const { return lattice_; }
  double h() const { return lattice_.h; }

  std::size_t n_nodes() const { return nodes_.size(); }
  std::size_t n_edges() const { return edges_.size(); }
  std::size_t n_faces() const { return faces_.size(); }
  std::size_t n_cells() const { return cells_.size(); }

  bool is_material(NodeId n) const { return material_[n] != 0; }
  Index3 index(NodeId n) const {
    const std::uint32_t run = nodes_.run_of(n.value);
    return unpack(run_keys_[run] + (n.value - nodes_.begin(run)));
  }
  /// Rest position [m].
  Vec3 position(NodeId n) const { return lattice_.position(index(n)); }
  /// Rest position of the cell's lowest node [m].
  Vec3 origin(CellId c) const { return position(nodes(c)[0]); }

  /// Which of the cell's vertices a node is, which of its lines an edge.
  int vertex(CellId c, NodeId n) const { return place_among(nodes(c), n); }
  int line(CellId c, EdgeId e) const { return place_among(edges(c), e); }

  /// In deal.II's local numbering (cube.h).
  std::array<NodeId, 8> nodes(CellId c) const;
  std::array<EdgeId, 12> edges(CellId c) const;
  std::array<FaceId, 6> faces(CellId c) const;

  /// Lower node first.
  std::array<NodeId, 2> ends(EdgeId e) const {
    const auto of = edges_.of(e.value);
    return {NodeId(of[0]), NodeId(of[1])};
  }
  int axis(EdgeId e) const { return e.value < first_edge_[1] ? 0 : e.value < first_edge_[2] ? 1 : 2; }
  /// The stored cells around an edge (up to four; the rest invalid): the i-th is (i & 1, i >> 1) cells lower along the
  /// two axes that follow the edge's own, cyclically.
  std::array<CellId, 4> cells(EdgeId e) const;
  /// The cells below and above a face; invalid where none is stored.
  std::array<CellId, 2> cells(FaceId f) const {
    const std::uint32_t run = faces_.run_of(f.value);
    return {CellId(faces_.at(f.value, 0, run)), CellId(faces_.at(f.value, 1, run))};
  }

  /// The edge from a node up along an axis, and the cell with this lowest node; invalid where none is stored.
  EdgeId edge(NodeId lower, int axis) const { return EdgeId(nodes_.at(lower.value, 1 + axis)); }
  CellId cell(NodeId lowest) const { return CellId(nodes_.at(lowest.value, 0)); }
  /// The cell on the other side of the cell's local face; invalid where none is stored.
  CellId neighbour(CellId c, int face) const { return CellId(faces_.at(faces(c)[face].value, face & 1)); }

  std::optional<NodeId> find_node(const Index3& i) const;
  std::optional<EdgeId> find_edge(const Index3& lower, int axis) const;
  std::optional<CellId> find_cell(const Index3& lower) const;

  /// The edges between a material and an empty node, ascending.
  std::vector<EdgeId> skin_edges() const;

  /// Memory of all tables [B].
  std::size_t n_bytes() const;

 private:
  struct Members;
  /// What is known of each cell: four nodes, edges and faces; of two side by side along x the lower one.
  enum CellKind { node = 0, edge_x = 4, edge_y = 8, edge_z = 10, face_x = 12, face_y = 13, face_z = 15, n_kinds = 17 };

  template <class Ids, class Id>
  static int place_among(const Ids& all, const Id id) {
    return static_cast<int>(std::find(all.begin(), all.end(), id) - all.begin());
  }

  explicit Grid(const Lattice& lattice) : lattice_(lattice) {}
  void make(const RowSet& material);
  void make_nodes(const Members& members, const RowSet& material);
  void make_cells(const Members& members);

  Lattice lattice_;
  std::array<std::uint32_t, 3> first_edge_{}; // by axis: ids run through x, y, z
  RunTable<4> nodes_;                         // the cell with this lowest node; the edges up along x, y, z
  std::vector<Key> run_keys_;                 // where each run of nodes begins
  RunTable<6> edges_;                         // lower and upper node; cells as in cells()
  RunTable<2> faces_;                         // the cells below and above
  RunTable<n_kinds> cells_;
  Table<NodeId, std::uint8_t> material_;
};

inline std::array<NodeId, 8> Grid::nodes(const CellId c) const {
  const auto of = cells_.of(c.value);
  std::array<NodeId, 8> nodes;
  for (int v = 0; v < cube::n_vertices; ++v)
    nodes[v].value = of[node + (v >> 1)] + (v & 1);
  return nodes;
}

inline std::array<EdgeId, 12> Grid::edges(const CellId c) const {
  const auto of = cells_.of(c.value);
  std::array<EdgeId, 12> edges;
  for (int line = 0; line < cube::n_lines; ++line) {
    const int lower = cube::line_vertices[line][0], axis = cube::line_axis(line);
    edges[line].value = axis == 0 ? of[edge_x + (lower >> 1)]
                                  : of[axis == 1 ? edge_y + (lower >> 2) : edge_z + (lower >> 1)] + (lower & 1);
  }
  return edges;
}

inline std::array<FaceId, 6> Grid::faces(const CellId c) const {
  const auto of = cells_.of(c.value);
  return {FaceId(of[face_x]),     FaceId(of[face_x] + 1), FaceId(of[face_y]),
          FaceId(of[face_y + 1]), FaceId(of[face_z]),     FaceId(of[face_z + 1])};
}

inline std::array<CellId, 4> Grid::cells(const EdgeId e) const {
  const std::uint32_t run = edges_.run_of(e.value);
  std::array<CellId, 4> cells;
  for (int i = 0; i < 4; ++i)
    cells[i].value = edges_.at(e.value, 2 + i, run);
  return cells;
}

} // namespace kerf::grid
