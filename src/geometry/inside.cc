#include "geometry/inside.h"

#include "geometry/predicates.h"

namespace kerf::geometry {

namespace {

std::vector<std::array<Vec3, 3>> corners_of(const TriangleMesh& mesh) {
  std::vector<std::array<Vec3, 3>> all;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    all.push_back(corners(mesh, i));
  return all;
}

std::vector<Box> boxes_of(const std::vector<std::array<Vec3, 3>>& triangles) {
  std::vector<Box> boxes;
  for (const auto& triangle : triangles)
    boxes.push_back(box_around(triangle));
  return boxes;
}

} // namespace

Inside::Inside(const TriangleMesh& mesh)
  : triangles_(corners_of(mesh)), tree_(boxes_of(triangles_)), box_(bounding_box(mesh)) {}

bool Inside::contains(const Vec3& p) const {
  if (!box_.contains(p))
    return false;
  const Vec3 beyond = {p[0], p[1], box_.upper[2] + (box_.upper - box_.lower).norm()};
  bool is_inside = false;
  tree_.for_each({p, beyond}, [&](const std::uint32_t t) { is_inside ^= crosses(p, beyond, triangles_[t]); });
  return is_inside;
}

} // namespace kerf::geometry
