#pragma once

/// The front of a cut: where it ends inside the material, and a path leads around it.
///
/// Method: corners are the same when their coordinates are; faces with the same three corners (the two sides of a cut)
/// count once. An edge of exactly one face is on the border. It is *open* when a small loop from one side of its face
/// around the edge to the other crosses no face: so the border of a cut that lies on another face, on the skin for one,
/// is no front, and neither is one that a later face runs over. Faces that share corners are one *sheet*.
///
/// Limits: the loop reaches 1e-6 of the edge's length beyond the edge; fronts closer than this have merged. Where the
/// cut ends at the skin of the body, the skin's faces must be there too, or the path leads around outside.

#include "visibility/cut_faces.h"

#include <optional>

namespace kerf::visibility {

struct FrontEdge {
  Vec3 from, to;       ///< [m]
  Vec3 outwards;       ///< in the plane of the face, away from it, at a right angle to the edge, unit
  std::uint32_t sheet; ///< of its face

  double length() const { return (to - from).norm(); }
};

/// Built once, asked often.
class Front {
 public:
  explicit Front(const CutFaces& cut);

  const std::vector<FrontEdge>& edges() const { return edges_; }

  /// The sheet that a face belongs to.
  std::uint32_t sheet(std::uint32_t face) const { return sheet_[face]; }

  /// The edges whose box overlaps `box`, in increasing order.
  std::vector<std::uint32_t> near(const Box& box) const;

 private:
  std::vector<FrontEdge> edges_;
  std::vector<std::uint32_t> sheet_;
  geometry::BoxTree tree_;
};

} // namespace kerf::visibility
