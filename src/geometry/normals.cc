#include "geometry/normals.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace kerf::geometry {

LocalNormals::LocalNormals(const TriangleMesh& mesh) : mesh_(mesh), start_(mesh.vertices.size() + 1, 0) {
  area_normals_.reserve(mesh.triangles.size());
  lengths_.reserve(mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto [a, b, c] = corners(mesh, i);
    area_normals_.push_back((b - a).cross(c - a));
    lengths_.push_back(area_normals_.back().norm());
    for (const auto v : mesh.triangles[i])
      ++start_[v + 1];
  }
  for (std::size_t v = 1; v < start_.size(); ++v)
    start_[v] += start_[v - 1];
  users_.resize(3 * mesh.triangles.size());
  std::vector<std::uint32_t> next(start_.begin(), start_.end() - 1);
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i)
    for (const auto v : mesh.triangles[i])
      users_[next[v]++] = i;
}

Vec3 LocalNormals::at(const std::uint32_t triangle, const Vec3& point, const double radius, Marks& marks) const {
  const double crease = std::sqrt(0.5);
  const Vec3 own = area_normals_[triangle];
  if (own.isZero(0))
    return own;
  marks.clear();
  marks.mark_triangle(triangle);
  marks.found_.push_back(triangle);
  Vec3 sum = own;
  for (std::size_t k = 0; k < marks.found_.size(); ++k)
    for (const auto v : mesh_.triangles[marks.found_[k]]) {
      if (!marks.mark_vertex(v) || (mesh_.vertices[v] - point).squaredNorm() > radius * radius)
        continue;
      for (auto u = start_[v]; u < start_[v + 1]; ++u) {
        const Vec3& other = area_normals_[users_[u]];
        if (!marks.mark_triangle(users_[u]) || !(other.dot(own) > crease * lengths_[users_[u]] * lengths_[triangle]))
          continue;
        marks.found_.push_back(users_[u]);
        sum += other;
      }
    }
  return sum.normalized();
}

} // namespace kerf::geometry
