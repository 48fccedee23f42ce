#pragma once

/// Normals of a mesh at the scale of whoever asks: a scan's single triangles are noise to a grid of larger cubes,
/// while a sharp edge must stay sharp.

#include "geometry/triangle_mesh.h"

#include <utility>

namespace kerf::geometry {

class LocalNormals {
 public:
  /// The mesh must outlive it.
  explicit LocalNormals(const TriangleMesh& mesh);

  /// What a question has seen of the mesh. One for each thread, used again and again: a question takes time by what it
  /// finds, not by the size of the mesh.
  class Marks {
   public:
    explicit Marks(const LocalNormals& normals)
      : vertices_(normals.mesh_.vertices.size(), 0), triangles_(normals.mesh_.triangles.size(), 0) {}

   private:
    friend class LocalNormals;
    void clear() {
      ++question_;
      found_.clear();
    }
    /// False for what is marked already.
    bool mark_vertex(const std::uint32_t v) { return std::exchange(vertices_[v], question_) != question_; }
    bool mark_triangle(const std::uint32_t t) { return std::exchange(triangles_[t], question_) != question_; }

    std::vector<std::uint32_t> vertices_, triangles_; // the question that marked each of them last
    std::vector<std::uint32_t> found_;                // triangles
    std::uint32_t question_ = 0;
  };

  /// Unit normal at a point [m] of triangle `triangle`: the mean, by area, over that triangle and those connected to
  /// it by triangles with a vertex within `radius` [m] of the point and a normal within 45 degrees of its own. Zero
  /// for a triangle without area.
  Vec3 at(std::uint32_t triangle, const Vec3& point, double radius, Marks& marks) const;

 private:
  const TriangleMesh& mesh_;
  Points area_normals_;                      // by triangle; length is twice the area
  std::vector<double> lengths_;              // of these normals
  std::vector<std::uint32_t> start_, users_; // triangles of vertex v: users_[start_[v] .. start_[v + 1]]
};

} // namespace kerf::geometry
