#include "geometry/shapes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace kerf::geometry {

namespace {

/// Each triangle in four; new vertices on the unit sphere.
void refine(TriangleMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
  const auto middle = [&](const std::uint32_t a, const std::uint32_t b) {
    const auto [position, is_new] =
      middles.emplace(std::minmax(a, b), static_cast<std::uint32_t>(mesh.vertices.size()));
    if (is_new)
      mesh.vertices.push_back((mesh.vertices[a] + mesh.vertices[b]).normalized());
    return position->second;
  };
  std::vector<Triangle> finer;
  for (const auto& [a, b, c] : mesh.triangles) {
    const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
  }
  mesh.triangles = std::move(finer);
}

} // namespace

TriangleMesh box_mesh(const Vec3& lower, const Vec3& upper) {
  TriangleMesh mesh;
  for (int v = 0; v < 8; ++v)
    mesh.vertices.emplace_back(v & 1 ? upper[0] : lower[0], v & 2 ? upper[1] : lower[1], v & 4 ? upper[2] : lower[2]);
  mesh.triangles = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
  return mesh;
}

TriangleMesh sphere_mesh(const double radius, const Vec3& centre, const int n) {
  TriangleMesh mesh;
  mesh.vertices = {Vec3::UnitX(), -Vec3::UnitX(), Vec3::UnitY(), -Vec3::UnitY(), Vec3::UnitZ(), -Vec3::UnitZ()};
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int level = 0; level < n; ++level)
    refine(mesh);
  for (Vec3& v : mesh.vertices)
    v = centre + radius * v;
  return mesh;
}

TriangleMesh ball_mesh(const Vec3& centre, const double radius, const double edge) {
  constexpr int least = 3, most = 8;
  constexpr double longest =
    2; // a triangle's side at level 0 is pi / 2, and those in its middle grow by a quarter at most
  const double levels = std::ceil(std::log2(longest * radius / edge));
  TriangleMesh mesh = sphere_mesh(1, Vec3::Zero(), static_cast<int>(std::clamp<double>(levels, least, most)));
  const double grown = radius * std::cbrt(4 * std::numbers::pi / 3 / volume(mesh));
  return placed(std::move(mesh), grown * Mat3::Identity(), centre);
}

TriangleMesh cylinder_mesh(const double radius, const double height, const double edge) {
  constexpr double least = 48, most = 4096, pi = std::numbers::pi;
  const auto n = static_cast<std::uint32_t>(std::clamp(std::ceil(2 * pi * radius / edge), least, most));
  const double grown = radius * std::sqrt(2 * pi / n / std::sin(2 * pi / n));
  TriangleMesh mesh;
  mesh.vertices = {Vec3(0, 0, -0.5 * height), Vec3(0, 0, 0.5 * height)};
  for (std::uint32_t i = 0; i < n; ++i) {
    const Vec3 out = grown * Vec3(std::cos(2 * pi * i / n), std::sin(2 * pi * i / n), 0);
    mesh.vertices.push_back(out + mesh.vertices[0]);
    mesh.vertices.push_back(out + mesh.vertices[1]);
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t a = 2 + 2 * i, b = 2 + 2 * ((i + 1) % n); // below; above them a + 1, b + 1
    mesh.triangles.insert(mesh.triangles.end(), {{0, b, a}, {1, a + 1, b + 1}, {a, b, b + 1}, {a, b + 1, a + 1}});
  }
  return mesh;
}

TriangleMesh placed(TriangleMesh mesh, const Mat3& rotation, const Vec3& way) {
  for (Vec3& v : mesh.vertices)
    v = rotation * v + way;
  return mesh;
}

} // namespace kerf::geometry
