#include "render/blade.h"

#include <Eigen/Geometry>

#include <array>

namespace kerf::render {

namespace {

// Shares of the depth |spine|: the eye reads them as a scalpel.
constexpr double thickness = 0.05, bevel_depth = 0.22;

// The outline of a cross-section, from the cutting edge around one side, the back, the other side.
constexpr int n_outline = 5;
constexpr std::array<std::uint16_t, n_outline> outline_labels = {1, 0, 2, 0, 1};

/// Directions across the plate at each point of the edge, unit; the mean of the two segments that meet there.
Points across(const Points& edge, const Vec3& spine) {
  Points directions;
  for (std::size_t i = 0; i < edge.size(); ++i) {
    Vec3 sum = Vec3::Zero();
    if (i > 0)
      sum += (edge[i] - edge[i - 1]).normalized();
    if (i + 1 < edge.size())
      sum += (edge[i + 1] - edge[i]).normalized();
    const Vec3 normal = sum.cross(spine);
    directions.push_back(normal.norm() > 0 ? Vec3(normal.normalized()) : spine.unitOrthogonal());
  }
  return directions;
}

} // namespace

ToolMesh blade_mesh(const Points& edge, const Vec3& spine) {
  ToolMesh mesh;
  const Points points = without_repeats(edge);
  if (points.size() < 2 || spine.norm() == 0)
    return mesh;
  const Points normals = across(points, spine);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 half = thickness / 2 * spine.norm() * normals[i];
    const Vec3 shoulder = points[i] + bevel_depth * spine, back = points[i] + spine;
    mesh.positions.insert(mesh.positions.end(),
                          {points[i], shoulder + half, back + half, back - half, shoulder - half});
  }
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint16_t label) {
    mesh.triangles.push_back({a, b, c});
    mesh.labels.push_back(label);
  };
  const auto n = static_cast<std::uint32_t>(points.size());
  for (std::uint32_t i = 0; i + 1 < n; ++i)
    for (std::uint32_t k = 0; k < n_outline; ++k) {
      const std::uint32_t a = n_outline * i + k, b = n_outline * i + (k + 1) % n_outline;
      add(a, b + n_outline, b, outline_labels[k]);
      add(a, a + n_outline, b + n_outline, outline_labels[k]);
    }
  const std::uint32_t last = n_outline * (n - 1);
  for (std::uint32_t k = 1; k + 1 < n_outline; ++k) {
    add(0, k, k + 1, 2);
    add(last, last + k + 1, last + k, 2);
  }
  return mesh;
}

} // namespace kerf::render
