#pragma once

/// The lattice of cubes around a body, stored only where there is material (thesis §2.4): every cell that touches a
/// material node, and those cells' nodes, edges and faces. Which nodes hold material never changes; which edges are cut
/// is kept beside it (cuts.h).
///
/// Notation: an edge or face is named by its lower node and its axis (the direction of the edge, the normal of the
/// face). Packed lattice coordinates are sorted, and a shift by a node keeps their order, so everything is built by
/// linear merges, and edges and cells are found by the place of their lowest node among all lowest nodes.
/// Limit: at most 2^20 nodes along an axis, none with a negative coordinate.

#include "base/id.h"
#include "base/vec.h"
#include "grid/ranked_set.h"

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

class Grid {
 public:
  /// Builds the cells that touch the given material nodes (coordinates from 1; duplicates are ignored). Throws
  /// DataError when there are none, or too many along an axis.
  Grid(const Lattice& lattice, std::vector<Index3> material_nodes);

  const Lattice& lattice() const { return lattice_; }
  double h() const { return lattice_.h; }

  std::size_t n_nodes() const { return node_keys_.size(); }
  std::size_t n_edges() const { return edge_ends_.size(); }
  std::size_t n_faces() const { return face_cells_.size(); }
  std::size_t n_cells() const { return cell_nodes_.size(); }

  bool is_material(NodeId n) const { return material_[n] != 0; }
  Index3 index(NodeId n) const;
  /// Rest position [m].
  Vec3 position(NodeId n) const { return lattice_.position(index(n)); }
  /// Rest position of the cell's lowest node [m].
  Vec3 origin(CellId c) const { return position(cell_nodes_[c][0]); }

  /// In deal.II's local numbering (cube.h).
  const std::array<NodeId, 8>& nodes(CellId c) const { return cell_nodes_[c]; }
  const std::array<EdgeId, 12>& edges(CellId c) const { return cell_edges_[c]; }
  const std::array<FaceId, 6>& faces(CellId c) const { return cell_faces_[c]; }

  /// Lower node first.
  const std::array<NodeId, 2>& ends(EdgeId e) const { return edge_ends_[e]; }
  int axis(EdgeId e) const { return e.value < first_edge_[1] ? 0 : e.value < first_edge_[2] ? 1 : 2; }
  /// The stored cells around an edge (up to four; the rest invalid).
  std::array<CellId, 4> cells(EdgeId e) const;
  /// The cells below and above a face; invalid where none is stored.
  const std::array<CellId, 2>& cells(FaceId f) const { return face_cells_[f]; }

  /// The edge from a node up along an axis, and the cell with this lowest node; invalid where none is stored.
  EdgeId edge(NodeId lower, int axis) const;
  CellId cell(NodeId lowest) const;
  /// The cell on the other side of the cell's local face; invalid where none is stored.
  CellId neighbour(CellId c, int face) const { return face_cells_[cell_faces_[c][face]][face & 1]; }

  std::optional<NodeId> find_node(const Index3& i) const;
  std::optional<EdgeId> find_edge(const Index3& lower, int axis) const;
  std::optional<CellId> find_cell(const Index3& lower) const;

  /// Memory of all tables [B].
  std::size_t n_bytes() const;

 private:
  using Keys = std::vector<std::uint64_t>;

  void make_cells(const Keys& cells);
  void make_edges(const Keys& cells);
  void make_faces(const Keys& cells);

  Lattice lattice_;
  Keys node_keys_;                            // lattice coordinates packed into one number, sorted
  RankedSet lowest_of_cell_;                  // nodes
  std::array<RankedSet, 3> lower_of_edge_;    // nodes, by axis
  std::array<std::uint32_t, 3> first_edge_{}; // by axis: ids run through x, y, z
  Table<NodeId, std::uint8_t> material_;
  Table<EdgeId, std::array<NodeId, 2>> edge_ends_;
  Table<FaceId, std::array<CellId, 2>> face_cells_;
  Table<CellId, std::array<NodeId, 8>> cell_nodes_;
  Table<CellId, std::array<EdgeId, 12>> cell_edges_;
  Table<CellId, std::array<FaceId, 6>> cell_faces_;
};

} // namespace kerf::grid
