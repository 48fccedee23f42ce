#pragma once

/// Small meshes for the tests of this room.

#include "base/vec.h"
#include "render/renderer.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

namespace kerf::render::shapes {

struct Mesh {
  Points positions; ///< [m]
  std::vector<Triangle> triangles;
  std::vector<std::uint16_t> labels;

  DrawnSurface drawn() const { return {positions, triangles, labels}; }
};

/// A cube about the origin; its +x side is labelled 1.
inline Mesh cube(double edge) {
  Mesh m;
  for (int v = 0; v < 8; ++v)
    m.positions.push_back(edge * (Vec3(v & 1, (v >> 1) & 1, (v >> 2) & 1) - Vec3::Constant(0.5)));
  const std::uint32_t sides[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                     {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (int s = 0; s < 6; ++s) {
    const auto& q = sides[s];
    m.triangles.insert(m.triangles.end(), {Triangle{q[0], q[1], q[2]}, Triangle{q[0], q[2], q[3]}});
    m.labels.insert(m.labels.end(), 2, s == 1 ? 1 : 0);
  }
  return m;
}

/// A sphere about the origin: an octahedron whose triangles are split into four, n_splits times.
inline Mesh sphere(double radius, int n_splits) {
  Mesh m;
  m.positions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  m.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int split = 0; split < n_splits; ++split) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [it, added] = middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(m.positions.size()));
      if (added)
        m.positions.push_back((m.positions[a] + m.positions[b]).normalized());
      return it->second;
    };
    std::vector<Triangle> finer;
    for (const auto& [a, b, c] : m.triangles) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {Triangle{a, ab, ca}, Triangle{ab, b, bc}, Triangle{ca, bc, c}, Triangle{ab, bc, ca}});
    }
    m.triangles = finer;
  }
  for (Vec3& p : m.positions)
    p *= radius;
  m.labels.assign(m.triangles.size(), 0);
  return m;
}

/// Each directed edge once in each direction.
inline bool closed(const std::vector<Triangle>& triangles) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;
  for (const Triangle& t : triangles)
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t a = t[i], b = t[(i + 1) % 3];
      balance[std::minmax(a, b)] += a < b ? 1 : -1;
    }
  return std::all_of(balance.begin(), balance.end(), [](const auto& edge) { return edge.second == 0; });
}

/// Six times the volume that a closed mesh encloses; positive if its triangles are seen from outside.
inline double six_volumes(const Points& x, const std::vector<Triangle>& triangles) {
  double sum = 0;
  for (const auto& [a, b, c] : triangles)
    sum += x[a].dot(x[b].cross(x[c]));
  return sum;
}

} // namespace kerf::render::shapes
