#pragma once

/// Which edges are cut, where, and by what; and where the vertices that a cut makes inside faces and cells lie at rest.
/// Everything here is in the rest configuration.
///
/// An edge inside the body is cut once. An edge of the skin is cut by the skin, and may be cut once more, between its
/// material node and the skin: what lies between the two cuts is its rind. It holds no node, and yet it is
/// material: without it what a blade cuts between the last node and the skin would be lost.

#include "grid/grid.h"
#include "grid/sparse_index.h"

#include <algorithm>
#include <optional>
#include <span>
#include <vector>

namespace kerf::grid {

struct Solid; // solid.h

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

  void archive(Archive& a) { a(edge, t, normal, label); }
};

/// Whether a cut that parts the material of a face reaches its skin there. Where it does, at the rim of the cut, the
/// skin is parted; where it leaves the face through two of its edges, or ends inside, the skin stays whole, and holds
/// together what lies below it. Unsaid: parted where an edge between the face's material nodes is cut, else whole.
enum class Seam : std::uint8_t { unsaid, whole, parted };

/// Where blades have cut beside the skin in a face, or anywhere in a cell of the skin, the skin keeps its vertex, and
/// the cuts have their own. Where a cut meets the skin, at its rim, the skin's vertex stays with the part on its side
/// of the cut, and the other part's skin ends at the vertex of the cuts.
struct SkinPoint {
  static constexpr std::uint16_t all = 0xfff;
  Vec3 p = Vec3::Zero(); ///< [m]
  /// Bits of the lines of the skin to which it belongs: of the cell, or by their place in the face (cube::face_lines).
  std::uint16_t lines = all;
  bool has_rim = false; ///< the vertex of the cuts lies on a rim: later cuts leave it, but where it would fold the skin

  void archive(Archive& a) { a(p, lines, has_rim); }
};

class Cuts {
 public:
  explicit Cuts(const Grid& grid);

  bool is_cut(EdgeId e) const { return edge_cut_[e] != none; }
  /// The cut that bounds the material of the edge's nodes: of an edge that is cut twice the inner one. Null when the
  /// edge is not cut.
  const EdgeCut* find(EdgeId e) const {
    const std::uint32_t i = edge_cut_[e];
    return i == none ? nullptr : &cuts_[i];
  }
  bool is_cut_twice(EdgeId e) const { return outer_cut_[e] != none; }
  std::size_t n_cut_twice() const { return n_cut_twice_; }
  /// The outermost cut of an edge: the skin's on an edge of the skin. Null when the edge is not cut.
  const EdgeCut* find_outer(EdgeId e) const {
    const std::uint32_t i = outer_index(e);
    return i == none ? nullptr : &cuts_[i];
  }
  /// All of them, in the order in which they were added; both of an edge that is cut twice.
  std::span<const EdgeCut> all() const { return cuts_; }

  /// May a blade still cut the edge? An uncut edge between two material nodes, or one of the skin that is cut once.
  bool can_be_cut(const Grid& grid, EdgeId e) const;

  /// Cuts an edge; t is clamped. Throws std::logic_error where the edge cannot be cut once more, or the second cut of
  /// an edge of the skin does not lie between its material node and the skin.
  void add(const Grid& grid, EdgeCut cut);
  /// Makes room for so many cuts in all.
  void reserve(std::size_t n) { cuts_.reserve(n); }

  /// The 12 line bits of a cell, 0..4095.
  unsigned configuration(const Grid& grid, CellId c) const;

  /// Whether the skin of a face is parted: see Seam.
  Seam seam(FaceId f) const {
    const std::uint32_t i = seam_[f];
    return i == none ? Seam::unsaid : static_cast<Seam>(i);
  }
  void set_seam(FaceId f, Seam seam);

  /// What has been cut, and where skin has been parted, since settle() was called last: their vertices are yet to be
  /// placed.
  bool is_new(EdgeId e) const { return edge_cut_[e] != none && edge_cut_[e] >= n_settled_; }
  std::span<const EdgeCut> new_cuts() const { return all().subspan(n_settled_); }
  bool is_newly_parted(FaceId f) const { return std::ranges::binary_search(newly_parted_, f); }
  std::span<const FaceId> newly_parted() const { return newly_parted_; }
  void settle();

  /// The vertex in a face or a cell, where a cut has placed one; the middle otherwise is the caller's to know.
  const Vec3* point(FaceId f) const { return point_at(face_point_[f]); }
  const Vec3* point(CellId c) const { return point_at(cell_point_[c]); }
  void set_point(FaceId f, const Vec3& p) { set(face_point_.at(f), p); }
  void set_point(CellId c, const Vec3& p) { set(cell_point_.at(c), p); }

  /// The vertex of the skin, where the blades' cuts have another one; else null.
  const SkinPoint* skin_point(FaceId f) const { return skin_point_at(face_skin_point_[f]); }
  const SkinPoint* skin_point(CellId c) const { return skin_point_at(cell_skin_point_[c]); }
  void set_skin_point(FaceId f, const SkinPoint& p) { set(face_skin_point_.at(f), p); }
  void set_skin_point(CellId c, const SkinPoint& p) { set(cell_skin_point_.at(c), p); }

  /// The place of a cut edge in all(), as of find() and of find_outer().
  std::uint32_t index(EdgeId e) const { return edge_cut_[e]; }
  std::uint32_t outer_index(EdgeId e) const {
    const std::uint32_t outer = outer_cut_[e];
    return outer == none ? edge_cut_[e] : outer;
  }
  /// Memory of all tables [B].
  std::size_t n_bytes() const;
  void archive(Archive& a) {
    a(edge_cut_, outer_cut_, seam_, face_point_, face_skin_point_, cell_point_, cell_skin_point_, cuts_);
    a(n_cut_twice_, n_settled_, newly_parted_, points_, skin_points_);
  }

 private:
  static constexpr std::uint32_t none = Id<void>::no_value;

  const Vec3* point_at(const std::uint32_t i) const { return i == none ? nullptr : &points_[i]; }
  const SkinPoint* skin_point_at(const std::uint32_t i) const { return i == none ? nullptr : &skin_points_[i]; }
  void set(std::uint32_t& index, const Vec3& p);
  void set(std::uint32_t& index, const SkinPoint& p);

  SparseIndex<EdgeId> edge_cut_, outer_cut_; // the second only of edges that are cut twice
  SparseIndex<FaceId> seam_;
  SparseIndex<FaceId> face_point_, face_skin_point_;
  SparseIndex<CellId> cell_point_, cell_skin_point_;
  std::vector<EdgeCut> cuts_;
  std::size_t n_cut_twice_ = 0, n_settled_ = 0;
  std::vector<FaceId> newly_parted_; // ascending
  Points points_;
  std::vector<SkinPoint> skin_points_;
};

/// Rest position [m] of the point on an edge (its cut, else its middle), in a face and in a cell (placed, else centre).
Vec3 edge_point(const Solid& solid, EdgeId e);
Vec3 face_point(const Solid& solid, FaceId f);
Vec3 cell_point(const Solid& solid, CellId c);

/// The same of the skin [m]; in a face for its i-th line, in a cell for a line of its.
Vec3 edge_skin_point(const Solid& solid, EdgeId e);
Vec3 face_skin_point(const Solid& solid, FaceId f, int i);
Vec3 cell_skin_point(const Solid& solid, CellId c, int line);

/// Centre of a face [m].
Vec3 centre(const Grid& grid, FaceId f);
/// Centre of a cell [m].
Vec3 centre(const Grid& grid, CellId c);

} // namespace kerf::grid
