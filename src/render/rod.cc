#include "render/rod.h"

#include <Eigen/Geometry>

#include <cmath>
#include <numbers>

namespace kerf::render {

namespace {

constexpr std::uint32_t n_around = 16;

/// Unit direction of the path at each of its points: the mean of the two segments that meet there.
Points directions(const Points& path) {
  Points result;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const Vec3 in = i > 0 ? Vec3((path[i] - path[i - 1]).normalized()) : Vec3::Zero();
    const Vec3 out = i + 1 < path.size() ? Vec3((path[i + 1] - path[i]).normalized()) : Vec3::Zero();
    result.push_back((in + out).norm() > 1e-9 ? Vec3((in + out).normalized()) : in);
  }
  return result;
}

/// The circle around a point of the path, from `across`, a unit vector at right angles to the direction.
void add_circle(const Vec3& centre, const Vec3& direction, const Vec3& across, const double radius, ToolMesh& mesh) {
  const Vec3 other = direction.cross(across);
  for (std::uint32_t k = 0; k < n_around; ++k) {
    const double angle = 2 * std::numbers::pi * k / n_around;
    mesh.positions.push_back(centre + radius * (std::cos(angle) * across + std::sin(angle) * other));
  }
}

} // namespace

ToolMesh rod_mesh(const Points& path, const double radius) {
  ToolMesh mesh;
  const Points points = without_repeats(path);
  if (points.size() < 2 || !(radius > 0))
    return mesh;
  const Points along = directions(points);
  Vec3 across = along.front().unitOrthogonal();
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i > 0) // carried without a twist
      across = (Eigen::Quaterniond::FromTwoVectors(along[i - 1], along[i]) * across).normalized();
    add_circle(points[i], along[i], across, radius, mesh);
  }
  const auto add = [&](const std::uint32_t a, const std::uint32_t b, const std::uint32_t c, const std::uint16_t label) {
    mesh.triangles.push_back({a, b, c});
    mesh.labels.push_back(label);
  };
  const auto last = static_cast<std::uint32_t>(n_around * (points.size() - 1));
  for (std::uint32_t first = 0; first < last; first += n_around)
    for (std::uint32_t k = 0; k < n_around; ++k) {
      const std::uint32_t a = first + k, b = first + (k + 1) % n_around;
      add(a, b, b + n_around, 0);
      add(a, b + n_around, a + n_around, 0);
    }
  for (std::uint32_t k = 1; k + 1 < n_around; ++k) {
    add(0, k + 1, k, 1);
    add(last, last + k, last + k + 1, 1);
  }
  return mesh;
}

} // namespace kerf::render
