#include "geometry/triangle_mesh.h"

#include "base/union_find.h"

#include <Eigen/Geometry>

#include <algorithm>

namespace kerf::geometry {

std::array<Vec3, 3> corners(const TriangleMesh& mesh, const std::size_t i) {
  const auto& [a, b, c] = mesh.triangles[i];
  return {mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]};
}

double volume(const TriangleMesh& mesh) {
  if (mesh.vertices.empty())
    return 0;
  const Vec3 apex = mesh.vertices.front(); // near the mesh, so that little cancels
  double six_volumes = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    six_volumes += (mesh.vertices[a] - apex).cross(mesh.vertices[b] - apex).dot(mesh.vertices[c] - apex);
  return six_volumes / 6;
}

Box bounding_box(const TriangleMesh& mesh) {
  if (mesh.vertices.empty())
    return {Vec3::Zero(), Vec3::Zero()};
  Box box{mesh.vertices.front(), mesh.vertices.front()};
  for (const Vec3& v : mesh.vertices) {
    box.lower = box.lower.cwiseMin(v);
    box.upper = box.upper.cwiseMax(v);
  }
  return box;
}

bool has_border(const TriangleMesh& mesh) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> sides;
  sides.reserve(3 * mesh.triangles.size());
  for (const Triangle& triangle : mesh.triangles)
    for (int i = 0; i < 3; ++i)
      sides.emplace_back(std::minmax(triangle[i], triangle[(i + 1) % 3]));
  std::ranges::sort(sides);
  for (auto first = sides.begin(); first != sides.end();) {
    const auto last = std::find_if(first, sides.end(), [&](const auto& side) { return side != *first; });
    if ((last - first) % 2 != 0)
      return true;
    first = last;
  }
  return false;
}

std::vector<std::uint32_t> shells(const TriangleMesh& mesh) {
  UnionFind classes(mesh.vertices.size());
  for (const auto& [a, b, c] : mesh.triangles) {
    classes.unite(a, b);
    classes.unite(b, c);
  }
  constexpr auto unnumbered = static_cast<std::uint32_t>(-1);
  std::vector<std::uint32_t> number(mesh.vertices.size(), unnumbered), shell;
  std::uint32_t n_shells = 0;
  shell.reserve(mesh.triangles.size());
  for (const Triangle& triangle : mesh.triangles) {
    std::uint32_t& n = number[classes.root(triangle[0])];
    if (n == unnumbered)
      n = n_shells++;
    shell.push_back(n);
  }
  return shell;
}

} // namespace kerf::geometry
