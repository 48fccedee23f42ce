#pragma once

/// Normals of a mesh at the scale of whoever asks: a scan's single triangles are noise to a grid of larger cubes,
/// while a sharp edge must stay sharp.

#include "geometry/triangle_mesh.h"

namespace kerf::geometry {

class LocalNormals {
 public:
  /// The mesh must outlive it.
  explicit LocalNormals(const TriangleMesh& mesh);

  /// Unit normal at a point [m] of triangle `triangle`: the mean, by area, over that triangle and those connected to
  /// it by triangles with a vertex within `radius` [m] of the point and a normal within 45 degrees of its own. Zero
  /// for a triangle without area.
  Vec3 at(std::uint32_t triangle, const Vec3& point, double radius) const;

 private:
  const TriangleMesh& mesh_;
  Points area_normals_;                      // by triangle; length is twice the area
  std::vector<std::uint32_t> start_, users_; // triangles of vertex v: users_[start_[v] .. start_[v + 1]]
};

} // namespace kerf::geometry
