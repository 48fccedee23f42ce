#pragma once

/// Is a point inside a closed mesh? Exact: a segment from the point to beyond the mesh crosses it an odd number of
/// times (predicates.h has one rule for every contact).

#include "geometry/box_tree.h"
#include "geometry/triangle_mesh.h"

namespace kerf::geometry {

class Inside {
 public:
  /// The mesh must be closed: require_solid().
  explicit Inside(const TriangleMesh& mesh);

  bool contains(const Vec3& p) const;

 private:
  std::vector<std::array<Vec3, 3>> triangles_;
  BoxTree tree_;
  Box box_;
};

} // namespace kerf::geometry
