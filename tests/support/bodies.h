#pragma once

/// Bodies and cut sets that tests make themselves, with fixed seeds.

#include "grid/solid.h"

#include <bit>
#include <cmath>
#include <random>
#include <vector>

namespace kerf::support {

using Random = std::mt19937;

using Body = grid::Solid;

/// With its copies, which are those of its cuts.
inline Body with_copies(Body body) {
  body.complex = grid::build_complex(body);
  return body;
}

inline double uniform(Random& random, const double from, const double to) {
  return std::uniform_real_distribution<double>(from, to)(random);
}

inline Vec3 random_vector(Random& random) {
  std::normal_distribution<double> normal;
  Vec3 v;
  for (int axis = 0; axis < 3; ++axis)
    v[axis] = normal(random);
  return v;
}

inline Vec3 random_direction(Random& random) { return random_vector(random).normalized(); }

/// Where the lattice stands, in parts of h.
inline Vec3 random_offset(Random& random) {
  Vec3 offset;
  for (int axis = 0; axis < 3; ++axis)
    offset[axis] = uniform(random, 0, 1);
  return offset;
}

/// The nodes 1 .. n along each axis, each kept with a probability.
inline std::vector<Index3> some_nodes(Random& random, const Index3& n, const double probability) {
  std::vector<Index3> nodes;
  for (int i = 1; i <= n[0]; ++i)
    for (int j = 1; j <= n[1]; ++j)
      for (int k = 1; k <= n[2]; ++k)
        if (uniform(random, 0, 1) < probability)
          nodes.push_back({i, j, k});
  return nodes;
}

inline std::vector<Index3> block_nodes(const Index3& n) {
  Random random;
  return some_nodes(random, n, 2);
}

/// A body whose skin cuts are what skin(grid, edge) returns for each edge between a material and an empty node.
template <class Skin>
Body make_body(const grid::Lattice& lattice, const std::vector<Index3>& nodes, const Skin& skin) {
  grid::Grid grid(lattice, nodes);
  grid::Cuts cuts(grid);
  for (const auto e : ids<grid::EdgeId>(grid.n_edges())) {
    const auto& [lower, upper] = grid.ends(e);
    if (grid.is_material(lower) != grid.is_material(upper))
      cuts.add(grid, skin(grid, e));
  }
  return {std::move(grid), std::move(cuts)};
}

/// The skin passes midway between nodes.
inline grid::EdgeCut midway(const grid::Grid& grid, const grid::EdgeId e) {
  return {e, 0.5, Vec3::Unit(grid.axis(e)), grid::skin_label};
}

/// n[0] x n[1] x n[2] cubes with one node in the middle of each: a box with its lower corner at h / 2.
inline Body block(const Index3& n, const double h = 1) { return make_body({Vec3::Zero(), h}, block_nodes(n), midway); }

/// A ball around the origin with exact crossings and normals; the lattice is moved by `offset` in parts of h.
inline Body ball(const double radius, const double h, const Vec3& offset) {
  const int n = static_cast<int>(std::ceil(radius / h)) + 3;
  const grid::Lattice lattice{-h * (Vec3::Constant(n) + offset), h};
  std::vector<Index3> nodes;
  for (const Index3& i : block_nodes({2 * n, 2 * n, 2 * n}))
    if (lattice.position(i).norm() < radius)
      nodes.push_back(i);
  return make_body(lattice, nodes, [&](const grid::Grid& grid, const grid::EdgeId e) {
    const int axis = grid.axis(e);
    Vec3 p = grid.position(grid.ends(e)[0]);
    const double start = p[axis];
    p[axis] = 0;
    const double half_chord = std::sqrt(radius * radius - p.squaredNorm());
    p[axis] = start < -half_chord ? -half_chord : half_chord;
    return grid::EdgeCut{e, (p[axis] - start) / h, p.normalized(), grid::skin_label};
  });
}

inline bool is_inner(const Body& body, const grid::EdgeId e) {
  const auto& [lower, upper] = body.grid.ends(e);
  return body.grid.is_material(lower) && body.grid.is_material(upper);
}

/// True for cells that hold an empty node.
inline bool is_skin_cell(const grid::Grid& grid, const grid::CellId c) {
  for (const auto n : grid.nodes(c))
    if (!grid.is_material(n))
      return true;
  return false;
}

/// Uncut edges between material nodes, each taken with a probability, with arbitrary positions (the very ends among
/// them) and normals.
inline std::vector<grid::EdgeCut> random_cuts(Random& random, const Body& body, const double probability,
                                              const grid::CutLabel label = 1) {
  std::vector<grid::EdgeCut> cuts;
  for (const auto e : ids<grid::EdgeId>(body.grid.n_edges()))
    if (is_inner(body, e) && !body.cuts.is_cut(e) && uniform(random, 0, 1) < probability)
      cuts.push_back({e, std::round(1e3 * uniform(random, -0.05, 1.05)) / 1e3, random_direction(random), label});
  return cuts;
}

struct Plane {
  Vec3 normal; ///< unit
  double offset;

  double height(const Vec3& p) const { return normal.dot(p) - offset; }
};

/// Does a crossing at t lie in the material of an edge of the skin?
inline bool is_below_skin(const Body& body, const grid::EdgeId e, const double t) {
  const double skin = body.cuts.find_outer(e)->t;
  return body.grid.is_material(body.grid.ends(e)[0]) ? t < skin - grid::min_edge_parameter
                                                     : t > skin + grid::min_edge_parameter;
}

/// The edges that a plane crosses in the material: those whose nodes, or node and point of the skin, it parts.
inline std::vector<grid::EdgeCut> plane_cuts(const Body& body, const Plane& plane, const grid::CutLabel label = 1) {
  std::vector<grid::EdgeCut> cuts;
  for (const auto e : ids<grid::EdgeId>(body.grid.n_edges())) {
    if (!body.cuts.can_be_cut(body.grid, e))
      continue;
    const auto [lower, upper] = body.grid.ends(e);
    const auto end = [&](const grid::NodeId n) {
      return body.grid.is_material(n) ? body.grid.position(n) : grid::edge_skin_point(body, e);
    };
    if ((plane.height(end(lower)) < 0) == (plane.height(end(upper)) < 0))
      continue;
    const double a = plane.height(body.grid.position(lower)), b = plane.height(body.grid.position(upper));
    cuts.push_back({e, a / (a - b), plane.normal, label});
  }
  return cuts;
}

/// The segments of the skin that a plane crosses.
inline std::vector<grid::SkinCut> plane_skin_cuts(const Body& body, const Plane& plane, const grid::CutLabel label = 1) {
  std::vector<grid::SkinCut> cuts;
  for (const auto c : ids<grid::CellId>(body.grid.n_cells())) {
    if (!is_skin_cell(body.grid, c))
      continue;
    const grid::Skeleton& skeleton = grid::skeleton_of(grid::material_of(body.grid, c));
    for (grid::Segments left = skeleton.segments & ~grid::skeleton::lines; left != 0; left &= left - 1) {
      const int segment = std::countr_zero(left);
      const grid::SkinSegment of_skin = grid::skin_segment(body.grid, c, segment);
      const auto& ends = skeleton.segment[segment].ends;
      const double a = plane.height(grid::item_point(body, c, ends[0])), b = plane.height(grid::item_point(body, c, ends[1]));
      const bool is_own = !of_skin.face.valid() || !body.grid.cells(of_skin.face)[0].valid() || body.grid.cells(of_skin.face)[0] == c;
      if (is_own && !body.cuts.is_cut(of_skin) && (a < 0) != (b < 0))
        cuts.push_back({of_skin, a / (a - b), plane.normal, label});
    }
  }
  return cuts;
}

/// Does a segment of a cell's skin join points above nodes that cut edges part: in the face of a half, in the cell?
inline bool is_above_cut(const Body& body, const grid::CellId c, const grid::Skeleton& skeleton, const int segment) {
  const auto& ends = skeleton.segment[segment].ends;
  const int a = skeleton.vertex[ends[0]], b = skeleton.vertex[ends[1]];
  const unsigned cut = body.cuts.configuration(body.grid, c);
  const unsigned within =
    segment < grid::skeleton::first_spoke ? grid::cube::face_mask((segment - grid::skeleton::first_half) / 4) : 0xffu;
  return (grid::cube::reachable(a, cut, within) >> b & 1) == 0;
}

/// The segments of the skin that are to be cut too, so that it does not hold together what cut edges part.
inline std::vector<grid::SkinCut> skin_cuts_above(const Body& body, const grid::CutLabel label = 1) {
  std::vector<grid::SkinCut> cuts;
  for (const auto c : ids<grid::CellId>(body.grid.n_cells())) {
    if (!is_skin_cell(body.grid, c))
      continue;
    const grid::Skeleton& skeleton = grid::skeleton_of(grid::material_of(body.grid, c));
    for (grid::Segments left = skeleton.segments & ~grid::skeleton::lines; left != 0; left &= left - 1) {
      const int segment = std::countr_zero(left);
      const grid::SkinSegment of_skin = grid::skin_segment(body.grid, c, segment);
      const bool is_own = !of_skin.face.valid() || body.grid.cells(of_skin.face)[1] == c ||
                          !body.grid.cells(of_skin.face)[1].valid();
      if (is_own && !body.cuts.is_cut(of_skin) && is_above_cut(body, c, skeleton, segment))
        cuts.push_back({of_skin, 0.5, Vec3::UnitX(), label});
    }
  }
  return cuts;
}

} // namespace kerf::support
