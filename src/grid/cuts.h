#pragma once

/// Which edges are cut, where, and by what; and where the vertices that a cut makes inside faces and cells lie at rest.
/// Everything here is in the rest configuration.
///
/// An edge inside the body is cut once. An edge of the skin is cut by the skin, and may be cut once more, between its
/// material node and the skin: what lies between the two cuts holds no node, and yet it is material. The skin's own
/// segments (skeleton.h) are cut once, like edges inside: so where a cut meets the skin is found, and not inferred from
/// edges.

#include "grid/grid.h"
#include "grid/skeleton.h"
#include "grid/sparse_index.h"

#include <map>
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

/// A segment of the skin (skeleton.h): half of an arc in a face, or a spoke in a cell.
struct SkinSegment {
  FaceId face;            ///< of a half; invalid for a spoke
  CellId cell;            ///< of a spoke; invalid for a half
  std::uint8_t place = 0; ///< of a half that of its line in the face; of a spoke from skeleton::first_spoke on

  static SkinSegment half(const FaceId f, const int place) { return {f, {}, static_cast<std::uint8_t>(place)}; }
  static SkinSegment spoke(const CellId c, const int place) { return {{}, c, static_cast<std::uint8_t>(place)}; }
  /// Halves first; by face or cell, then by place.
  auto operator<=>(const SkinSegment&) const = default;
  void archive(Archive& a) { a(face, cell, place); }
};

struct SkinCut {
  SkinSegment segment;
  double t = 0.5;              ///< from the segment's first end (Skeleton::Segment) to its second, as in EdgeCut [1]
  Vec3 normal = Vec3::UnitX(); ///< as in EdgeCut
  CutLabel label = 1;
  Vec3 aside = Vec3::Zero(); ///< of a spoke that another cut meets too: from there to where the two cross beside it, in
                             ///< the skin and in this one's plane, where their vertex is (surface/crossing.h) [m]

  void archive(Archive& a) { a(segment, t, normal, label, aside); }
};

/// Who meets a segment that another one has cut, or that waits, or was left whole: it parts nothing there, but tells on
/// which side of it the ends lie.
struct LaterCut {
  double t = 0.5;              ///< as in EdgeCut or SkinCut [1]
  Vec3 normal = Vec3::UnitX(); ///< as in EdgeCut
  CutLabel label = 1;

  void archive(Archive& a) { a(t, normal, label); }
};

/// What hangs together in a cell though cuts part all segments between (cut/sides.h).
struct Joined {
  Items items = 0;
  Intervals intervals = 0; ///< that belong to it

  Joined& operator|=(const Joined& other) {
    items |= other.items;
    intervals |= other.intervals;
    return *this;
  }
  bool operator==(const Joined&) const = default;
  void archive(Archive& a) { a(items, intervals); }
};

/// A cell in which a cut ends, or would by fronts.h: the copies are parted as if it went on through the cell in a
/// plane, and tied together as far as it has not come.
struct Front {
  CellId cell;
  Segments ahead = 0; ///< of the cell's segments those that the plane meets, but not the cut
  Vec3 point = Vec3::Zero(), normal = Vec3::UnitX(); ///< of the plane, rest frame [m], unit
  double passed = 1; ///< the part of its material in the cell that the cut has come to, in (0, 1] [1]
  CutLabel label = 1;
  std::array<double, 8> reached = {}; ///< by vertex: that part, weighted by its shape function [1]
  std::array<double, 8> held = {};    ///< by vertex: A / 3 (1 - f) / f of what holds the copies there (fronts.h) [m^2]
  Vec3 onward = Vec3::Zero(); ///< unit, in the plane: the way on from where the cut ends; zero where that is not known
  double end = 0; ///< onward . p of the line in which it ends, without the lag of fronts [m]
  std::vector<Points> come = {}; ///< where the cut has come in the cell, and a little beside it, since the front was
                                 ///< told last: convex polygons, rest frame [m]; for cut::Fronts::of_points

  void archive(Archive& a) { a(cell, ahead, point, normal, passed, label, reached, held, onward, end, come); }
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

  /// The place of a segment's cut in skin_cuts(); none where it is not cut.
  std::uint32_t index(const SkinSegment& segment) const;
  bool is_cut(const SkinSegment& segment) const { return index(segment) != none; }
  const SkinCut* find(const SkinSegment& segment) const {
    const std::uint32_t i = index(segment);
    return i == none ? nullptr : &skin_cuts_[i];
  }
  /// All of them, in the order in which they were added.
  std::span<const SkinCut> skin_cuts() const { return skin_cuts_; }
  /// Cuts a segment of the skin that is not cut yet; t is clamped.
  void add(SkinCut cut);
  /// Of a spoke that is cut.
  void set_aside(const SkinSegment& segment, const Vec3& aside) { skin_cuts_.at(index(segment)).aside = aside; }
  /// Takes back blades' cuts that are not settled yet (ascending). They were met, as of later cuts, and can be cut
  /// again.
  void leave_whole(std::span<const EdgeId> edges);
  void leave_whole(std::span<const SkinSegment> segments);
  const std::map<EdgeId, LaterCut>& edges_left_whole() const { return edges_left_whole_; }
  const std::map<SkinSegment, LaterCut>& segments_left_whole() const { return segments_left_whole_; }
  std::size_t n_left_whole() const { return edges_left_whole_.size() + segments_left_whole_.size(); }

  /// Each label once.
  void add(EdgeId e, const LaterCut& later) { add_to(later_of_edges_[e], later); }
  void add(const SkinSegment& segment, const LaterCut& later) { add_to(later_of_skin_[segment], later); }
  bool has_later_cuts() const { return !later_of_edges_.empty() || !later_of_skin_.empty(); }
  std::span<const LaterCut> later_cuts(const EdgeId e) const { return found_in(later_of_edges_, e); }
  std::span<const LaterCut> later_cuts(const SkinSegment& segment) const { return found_in(later_of_skin_, segment); }

  /// Null where there are none.
  const std::vector<Joined>* joined(const CellId c) const {
    const auto found = joined_.empty() ? joined_.end() : joined_.find(c);
    return found == joined_.end() ? nullptr : &found->second;
  }
  /// In place of the cell's earlier ones.
  void set_joined(CellId c, std::vector<Joined> groups);

  /// Null in cells where no cut ends.
  const Front* front(const CellId c) const {
    const std::uint32_t i = front_of_cell_[c];
    return i == none ? nullptr : &fronts_[i];
  }
  /// In no order that says anything.
  std::span<const Front> fronts() const { return fronts_; }
  /// In place of the cell's earlier one.
  void set(const Front& front);
  /// The cell is then as cuts have left it.
  void take_back_front(CellId c);

  /// What has been cut since settle() was called last: its vertices are yet to be placed.
  bool is_new(EdgeId e) const { return edge_cut_[e] != none && edge_cut_[e] >= n_settled_; }
  bool is_new(const SkinSegment& segment) const { return is_cut(segment) && index(segment) >= n_settled_of_skin_; }
  std::span<const EdgeCut> new_cuts() const { return all().subspan(n_settled_); }
  std::span<const SkinCut> new_skin_cuts() const { return skin_cuts().subspan(n_settled_of_skin_); }
  void settle();

  /// The vertex in a face or a cell, where a cut has placed one; the middle otherwise is the caller's to know. Where
  /// the skin passes through it is that of the skin.
  const Vec3* point(FaceId f) const { return point_at(face_point_[f]); }
  const Vec3* point(CellId c) const { return point_at(cell_point_[c]); }
  void set_point(FaceId f, const Vec3& p) { set(face_point_.at(f), p); }
  void set_point(CellId c, const Vec3& p) { set(cell_point_.at(c), p); }

  /// The vertex of blades' cuts where the skin passes through: in the polygon of a face at one of its arcs, in a cell,
  /// and in a triangle of the cell's skin (counted from skeleton::first_triangle on); null where there is none.
  const Vec3* inner_point(FaceId f, int arc) const;
  const Vec3* inner_point(CellId c) const { return inner_point_of(c, SkinOfCell::inner); }
  const Vec3* inner_point(CellId c, int triangle) const { return inner_point_of(c, SkinOfCell::triangles + triangle); }
  void set_inner_point(FaceId f, int arc, const Vec3& p);
  void set_inner_point(CellId c, const Vec3& p) { set(cell(c)[SkinOfCell::inner], p); }
  void set_inner_point(CellId c, int triangle, const Vec3& p) { set(cell(c)[SkinOfCell::triangles + triangle], p); }

  /// The place of a cut edge in all(), as of find() and of find_outer().
  std::uint32_t index(EdgeId e) const { return edge_cut_[e]; }
  std::uint32_t outer_index(EdgeId e) const {
    const std::uint32_t outer = outer_cut_[e];
    return outer == none ? edge_cut_[e] : outer;
  }
  /// Memory of all tables [B].
  std::size_t n_bytes() const;
  void archive(Archive& a) {
    a(edge_cut_, outer_cut_, face_point_, cell_point_, skin_of_face_, skin_of_cell_, faces_, cells_);
    a(cuts_, skin_cuts_, n_cut_twice_, n_settled_, n_settled_of_skin_, points_);
    a(front_of_cell_, fronts_, later_of_edges_, later_of_skin_, joined_, edges_left_whole_, segments_left_whole_);
  }

 private:
  static constexpr std::uint32_t none = Id<void>::no_value;
  /// What blades have done in a face of the skin: places in skin_cuts_ by half, in points_ by arc.
  struct SkinOfFace {
    static constexpr int halves = 0, inner = 4, n = 6;
  };
  /// In a cell of the skin: places in skin_cuts_ by spoke, in points_ of the triangles and of the cell.
  struct SkinOfCell {
    static constexpr int spokes = 0, triangles = 24, inner = 48, n = 49;
  };
  using FaceEntries = std::array<std::uint32_t, SkinOfFace::n>;
  using CellEntries = std::array<std::uint32_t, SkinOfCell::n>;

  static void add_to(std::vector<LaterCut>& all, const LaterCut& later);
  template <class Key>
  static std::span<const LaterCut> found_in(const std::map<Key, std::vector<LaterCut>>& all, const Key& key) {
    const auto found = all.empty() ? all.end() : all.find(key);
    return found == all.end() ? std::span<const LaterCut>() : found->second;
  }

  const Vec3* point_at(const std::uint32_t i) const { return i == none ? nullptr : &points_[i]; }
  const Vec3* inner_point_of(CellId c, int entry) const;
  void set(std::uint32_t& index, const Vec3& p);
  FaceEntries& face(FaceId f);
  CellEntries& cell(CellId c);
  std::uint32_t& entry(const SkinSegment& segment);

  SparseIndex<EdgeId> edge_cut_, outer_cut_; // the second only of edges that are cut twice
  SparseIndex<FaceId> face_point_;
  SparseIndex<CellId> cell_point_;
  SparseIndex<CellId> front_of_cell_; // into fronts_
  SparseIndex<FaceId> skin_of_face_;  // into faces_
  SparseIndex<CellId> skin_of_cell_;  // into cells_
  std::vector<FaceEntries> faces_;
  std::vector<CellEntries> cells_;
  std::vector<Front> fronts_;
  std::map<EdgeId, std::vector<LaterCut>> later_of_edges_;
  std::map<SkinSegment, std::vector<LaterCut>> later_of_skin_;
  std::map<CellId, std::vector<Joined>> joined_;
  std::map<EdgeId, LaterCut> edges_left_whole_;
  std::map<SkinSegment, LaterCut> segments_left_whole_;
  std::vector<EdgeCut> cuts_;
  std::vector<SkinCut> skin_cuts_;
  std::size_t n_cut_twice_ = 0, n_settled_ = 0, n_settled_of_skin_ = 0;
  Points points_;
};

/// Rest position [m] of the point on an edge (its inner cut, else its middle), in a face and in a cell (placed, else
/// centre; that of the skin where it passes through).
Vec3 edge_point(const Solid& solid, EdgeId e);
Vec3 face_point(const Solid& solid, FaceId f);
Vec3 cell_point(const Solid& solid, CellId c);
/// Of the outermost cut: where the skin is [m].
Vec3 edge_skin_point(const Solid& solid, EdgeId e);
/// Of an item of a cell's skeleton; of a segment of it, where a blade has cut it, else its middle [m].
Vec3 item_point(const Solid& solid, CellId c, int item);
Vec3 segment_point(const Solid& solid, CellId c, const Skeleton& skeleton, int segment);

/// Centre of a face [m].
Vec3 centre(const Grid& grid, FaceId f);
/// Centre of a cell [m].
Vec3 centre(const Grid& grid, CellId c);

} // namespace kerf::grid
