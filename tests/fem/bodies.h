#pragma once

/// Small bodies whose skin and cuts lie wherever a test wants them, without a mesh.

#include "grid/complex.h"
#include "surface/placement.h"
#include "tests/support/bodies.h"

#include <Eigen/Geometry>

#include <random>

namespace kerf::fem {

/// Random numbers with a fixed seed.
class Draw {
 public:
  explicit Draw(const unsigned seed) : engine_(seed) {}

  double operator()(const double lower, const double upper) {
    return std::uniform_real_distribution<double>(lower, upper)(engine_);
  }
  double normal() { return std::normal_distribution<double>()(engine_); }
  Vec3 vector() { return {normal(), normal(), normal()}; }
  Mat3 matrix() {
    Mat3 A;
    A << vector(), vector(), vector();
    return A;
  }
  Mat3 rotation() { return Eigen::Quaterniond(normal(), normal(), normal(), normal()).normalized().toRotationMatrix(); }

 private:
  std::mt19937 engine_;
};

/// Where cuts may lie on their edges [1].
struct Interval {
  double lower, upper;
};

struct Body : grid::Solid {
  /// Adds cuts, and what they part of the skin above; places the vertices they make and numbers the copies anew.
  void cut(const std::vector<grid::EdgeCut>& added) {
    for (const grid::EdgeCut& c : added)
      cuts.add(grid, c);
    for (const grid::SkinCut& c : support::skin_cuts_above(*this))
      cuts.add(c);
    surface::place(*this, {});
    complex = grid::build_complex(*this);
  }

  Points rest() const { return grid::rest_positions(*this); }
};

/// n[0] x n[1] x n[2] material nodes from lattice coordinates (1, 1, 1), inside a skin with random places and normals.
inline Body make_block(const Index3& n, const double h, Draw& draw, const Interval& t) {
  std::vector<Index3> nodes;
  for (int i = 0; i < n[0] * n[1] * n[2]; ++i)
    nodes.push_back({1 + i % n[0], 1 + i / n[0] % n[1], 1 + i / n[0] / n[1]});
  grid::Grid grid({Vec3(0.3, -0.2, 0.1), h}, nodes);
  grid::Cuts cuts(grid);
  Body body{{std::move(grid), std::move(cuts)}};
  std::vector<grid::EdgeCut> skin;
  for (const auto e : ids<grid::EdgeId>(body.grid.n_edges()))
    if (body.grid.is_material(body.grid.ends(e)[0]) != body.grid.is_material(body.grid.ends(e)[1]))
      skin.push_back({e, draw(t.lower, t.upper), draw.vector().normalized(), grid::skin_label});
  body.cut(skin);
  return body;
}

/// The uncut edges between two material nodes, in their order.
inline std::vector<grid::EdgeId> inner_edges(const Body& body) {
  std::vector<grid::EdgeId> edges;
  for (const auto e : ids<grid::EdgeId>(body.grid.n_edges()))
    if (!body.cuts.is_cut(e) && body.grid.is_material(body.grid.ends(e)[0]))
      edges.push_back(e);
  return edges;
}

/// Cuts each inner edge with the given probability.
inline void cut_at_random(Body& body, const double probability, Draw& draw, const Interval& t) {
  std::vector<grid::EdgeCut> cuts;
  for (const auto e : inner_edges(body))
    if (draw(0, 1) < probability)
      cuts.push_back({e, draw(t.lower, t.upper), draw.vector().normalized(), 1});
  body.cut(cuts);
}

/// Cuts every inner edge along `axis` that starts in lattice layer `layer`: a plane through the whole body.
inline void cut_plane(Body& body, const int axis, const int layer, const double t) {
  std::vector<grid::EdgeCut> cuts;
  for (const auto e : inner_edges(body))
    if (body.grid.axis(e) == axis && body.grid.index(body.grid.ends(e)[0])[axis] == layer)
      cuts.push_back({e, t, Vec3::Unit(axis), 1});
  body.cut(cuts);
}

} // namespace kerf::fem
