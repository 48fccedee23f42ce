#pragma once

/// Which edges are cut, where, and by what; and where the vertices that a cut makes inside faces and cells lie at rest.
/// Everything here is in the rest configuration.

#include "grid/grid.h"
#include "grid/sparse_index.h"

#include <optional>
#include <span>
#include <vector>

namespace kerf::grid {

/// Who cut an edge: 0 is the body's skin (the input mesh), 1, 2, ... the blades in the order of the scene.
using CutLabel = std::uint16_t;
constexpr CutLabel skin_label = 0;

/// No vertex of a cut lies closer than this to the end of its edge or the side of its face or cell, as a part of h [1].
/// Far below what matters, far above round-off: positions are exact, volumes stay positive.
constexpr double min_edge_parameter = 1e-10;

struct EdgeCut {
  EdgeId edge;
  double t = 0.5;              ///< position along the edge from its lower node, in [min_edge_parameter, 1 - ...] [1]
  Vec3 normal = Vec3::UnitX(); ///< unit normal of the cutting surface, rest frame; the sign has no meaning
  CutLabel label = skin_label;
};

class Cuts {
 public:
  explicit Cuts(const Grid& grid);

  bool is_cut(EdgeId e) const { return edge_cut_[e] != none; }
  /// Null when the edge is not cut.
  const EdgeCut* find(EdgeId e) const {
    const std::uint32_t i = edge_cut_[e];
    return i == none ? nullptr : &cuts_[i];
  }
  std::span<const EdgeCut> all() const { return cuts_; }

  /// Cuts an uncut edge; t is clamped. An edge is cut once.
  void add(EdgeCut cut);
  /// Makes room for so many cuts in all.
  void reserve(std::size_t n) { cuts_.reserve(n); }

  /// The 12 line bits of a cell, 0..4095.
  unsigned configuration(const Grid& grid, CellId c) const;

  /// The vertex in a face or a cell, where a cut has placed one; the middle otherwise is the caller's to know.
  const Vec3* point(FaceId f) const { return point_at(face_point_[f]); }
  const Vec3* point(CellId c) const { return point_at(cell_point_[c]); }
  void set_point(FaceId f, const Vec3& p) { set(face_point_.at(f), p); }
  void set_point(CellId c, const Vec3& p) { set(cell_point_.at(c), p); }

  /// The place of a cut edge in all().
  std::uint32_t index(EdgeId e) const { return edge_cut_[e]; }
  /// Memory of all tables [B].
  std::size_t n_bytes() const;

 private:
  static constexpr std::uint32_t none = Id<void>::no_value;

  const Vec3* point_at(const std::uint32_t i) const { return i == none ? nullptr : &points_[i]; }
  void set(std::uint32_t& index, const Vec3& p);

  SparseIndex<EdgeId> edge_cut_;
  SparseIndex<FaceId> face_point_;
  SparseIndex<CellId> cell_point_;
  std::vector<EdgeCut> cuts_;
  Points points_;
};

/// Rest position [m] of the point on an edge (its cut, else its middle), in a face and in a cell (placed, else centre).
Vec3 edge_point(const Grid& grid, const Cuts& cuts, EdgeId e);
Vec3 face_point(const Grid& grid, const Cuts& cuts, FaceId f);
Vec3 cell_point(const Grid& grid, const Cuts& cuts, CellId c);

/// Centre of a face [m].
Vec3 centre(const Grid& grid, FaceId f);
/// Centre of a cell [m].
Vec3 centre(const Grid& grid, CellId c);

/// Vertices of a tetrahedron in coordinates of its cell, the unit cube [1].
using Tetrahedron = std::array<Vec3, 4>;

/// The octant of a cell: the material that belongs to `vertex`, as six positively oriented tetrahedra,
/// one for each way node - edge point - face point - centre. The eight octants of a cell tile it. Departs from the
/// trilinear hexahedron on the same eight points: tetrahedra have positive volume for every point inside its edge,
/// face and cell (a hexahedron folds where a cut leaves a face vertex in the chord of its edge vertices), and they
/// are bounded by just the triangles of the surface, so that volume by surface and mass by octants agree to round-
/// off.
std::array<Tetrahedron, 6> octant(const Grid& grid, const Cuts& cuts, CellId c, int vertex);

} // namespace kerf::grid
