#include "render/shading.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace kerf::render {

namespace {

/// Corner c = 3 t + i is vertex i of triangle t.
using Corner = std::uint32_t;

struct Shading {
  std::span<const Vec3> positions;
  std::span<const Triangle> triangles;
  std::span<const std::uint16_t> labels;
  double smallest_cosine;
  std::vector<Vec3> doubled_areas; ///< normal of each triangle, as long as twice its area

  std::uint16_t label(Corner c) const { return labels.empty() ? std::uint16_t{0} : labels[c / 3]; }
  std::uint32_t vertex(Corner c, int offset) const { return triangles[c / 3][(c % 3 + offset) % 3]; }

  bool share_edge(Corner a, Corner b) const { return vertex(a, 1) == vertex(b, 2) || vertex(a, 2) == vertex(b, 1); }

  /// A triangle without area has no normal, so it never makes a crease.
  bool smooth(Corner a, Corner b) const {
    const Vec3& n = doubled_areas[a / 3];
    const Vec3& m = doubled_areas[b / 3];
    return label(a) == label(b) && n.dot(m) >= smallest_cosine * n.norm() * m.norm();
  }

  Vec3 weighted_normal(Corner c) const {
    const Vec3 p = positions[vertex(c, 0)];
    const Vec3 u = positions[vertex(c, 1)] - p, v = positions[vertex(c, 2)] - p;
    return std::atan2(u.cross(v).norm(), u.dot(v)) * doubled_areas[c / 3];
  }
};

/// The corners at each vertex, one vertex after the other.
struct Incidence {
  std::vector<std::uint32_t> first;
  std::vector<Corner> corners;
};

Incidence incidence(std::span<const Triangle> triangles, std::size_t n_vertices) {
  Incidence in{std::vector<std::uint32_t>(n_vertices + 1, 0), std::vector<Corner>(3 * triangles.size())};
  for (const Triangle& t : triangles)
    for (const auto v : t)
      ++in.first[v + 1];
  std::partial_sum(in.first.begin(), in.first.end(), in.first.begin());
  std::vector<std::uint32_t> next(in.first.begin(), in.first.end() - 1);
  for (Corner c = 0; c < in.corners.size(); ++c)
    in.corners[next[triangles[c / 3][c % 3]]++] = c;
  return in;
}

/// fan[i] = the lowest index of a corner that is joined to corner i by smooth edges.
void find_fans(const Shading& shading, std::span<const Corner> corners, std::vector<std::size_t>& fan) {
  fan.resize(corners.size());
  std::iota(fan.begin(), fan.end(), std::size_t{0});
  for (std::size_t i = 0; i < corners.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      if (fan[i] == fan[j] || !shading.share_edge(corners[i], corners[j]) || !shading.smooth(corners[i], corners[j]))
        continue;
      const auto [kept, lost] = std::minmax(fan[i], fan[j]);
      // By value: both are references into the vector that is written here.
      std::replace(fan.begin(), fan.end(), std::size_t{lost}, std::size_t{kept});
    }
}

std::vector<Vec3> doubled_areas(std::span<const Vec3> x, std::span<const Triangle> triangles) {
  std::vector<Vec3> areas;
  areas.reserve(triangles.size());
  for (const auto& [a, b, c] : triangles)
    areas.push_back((x[b] - x[a]).cross(x[c] - x[a]));
  return areas;
}

/// Adds one shaded vertex for each fan among the corners of one vertex.
void add_fans(const Shading& shading, std::span<const Corner> corners, std::vector<std::size_t>& fan,
              ShadedMesh& mesh) {
  find_fans(shading, corners, fan);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (fan[i] != i)
      continue;
    Vec3 normal = Vec3::Zero();
    for (std::size_t j = i; j < corners.size(); ++j)
      if (fan[j] == i) {
        normal += shading.weighted_normal(corners[j]);
        mesh.triangles[corners[j] / 3][corners[j] % 3] = static_cast<std::uint32_t>(mesh.vertices.size());
      }
    const double length = normal.norm();
    mesh.vertices.push_back(
      {shading.vertex(corners[i], 0), shading.label(corners[i]), length > 0 ? Vec3(normal / length) : Vec3(0, 0, 1)});
  }
}

} // namespace

ShadedMesh shade(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                 std::span<const std::uint16_t> labels, double crease_angle) {
  const Shading shading{positions, triangles, labels, std::cos(crease_angle * std::numbers::pi / 180),
                        doubled_areas(positions, triangles)};
  const Incidence in = incidence(triangles, positions.size());
  ShadedMesh mesh;
  mesh.triangles.resize(triangles.size());
  mesh.vertices.reserve(positions.size());
  std::vector<std::size_t> fan;
  for (std::size_t v = 0; v < positions.size(); ++v)
    add_fans(shading, std::span(in.corners).subspan(in.first[v], in.first[v + 1] - in.first[v]), fan, mesh);
  return mesh;
}

} // namespace kerf::render
