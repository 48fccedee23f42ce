#pragma once

/// Cut bodies, states, and the definitions of lattice shape matching written down once more, without anything fast.

#include "dynamics/state.h"
#include "lattice/shape_matching.h"
#include "material/polar.h"
#include "tests/fem/bodies.h"

#include <map>

namespace kerf::lattice {

using fem::Body;
using fem::Draw;

/// A block with a rough skin, its inner edges cut with a probability at places anywhere.
inline Body cut_block(const unsigned seed, const Index3& n, const double probability, const double h = 0.1) {
  Draw draw(seed);
  Body body = fem::make_block(n, h, draw, {0.02, 0.98});
  fem::cut_at_random(body, probability, draw, {0.02, 0.98});
  return body;
}

/// Turned, moved, and out of shape by `noise` in parts of h.
inline Points moved(const Body& body, Draw& draw, const double noise) {
  Points x = body.rest();
  const Mat3 Q = draw.rotation();
  const Vec3 shift = draw.vector();
  for (Vec3& p : x)
    p = Q * p + shift + noise * body.grid.h() * draw.vector();
  return x;
}

/// The node one step along an axis, where there is such a step.
inline std::optional<grid::NodeId> step(const Body& body, const grid::NodeId n, const int axis, const int sign) {
  Index3 lower = body.grid.index(n);
  if (sign < 0)
    --lower[axis];
  const auto edge = body.grid.find_edge(lower, axis);
  if (!edge || body.cuts.is_cut(*edge))
    return std::nullopt;
  return body.grid.ends(*edge)[sign < 0 ? 0 : 1];
}

/// The nodes at most w steps away along an axis, n among them.
inline std::vector<grid::NodeId> walk(const Body& body, const grid::NodeId n, const int axis, const int w) {
  std::vector<grid::NodeId> nodes = {n};
  for (const int sign : {-1, 1}) {
    auto at = step(body, n, axis, sign);
    for (int i = 0; i < w && at; ++i, at = step(body, *at, axis, sign))
      nodes.push_back(*at);
  }
  return nodes;
}

/// The region of a node: along z, from there along y, from there along x.
inline std::vector<grid::NodeId> region(const Body& body, const grid::NodeId r, const int w) {
  std::vector<grid::NodeId> nodes;
  for (const auto a : walk(body, r, 2, w))
    for (const auto b : walk(body, a, 1, w))
      for (const auto c : walk(body, b, 0, w))
        nodes.push_back(c);
  return nodes;
}

/// Matching by its definition, region by region.
struct Reference {
  std::vector<std::map<std::uint32_t, double>> mass_in; ///< m_rc, by region and corner [kg]
  std::vector<double> mass;                             ///< m_c [kg]
  Points rest;

  Reference(const Body& body, const int w, const double density)
    : mass(body.complex.n_corners(), 0.0), rest(body.rest()) {
    const auto shares = material_shares(body, density);
    std::vector<std::vector<grid::NodeId>> regions;
    std::map<grid::NodeId, double> n_holders;
    for (const auto n : ids<grid::NodeId>(body.grid.n_nodes()))
      if (body.grid.is_material(n)) {
        regions.push_back(region(body, n, w));
        for (const auto m : regions.back())
          n_holders[m] += 1;
      }
    for (const auto& nodes : regions) {
      auto& masses = mass_in.emplace_back();
      for (const Share& s : shares)
        if (std::find(nodes.begin(), nodes.end(), s.node) != nodes.end())
          masses[s.corner.value] += s.mass / n_holders.at(s.node);
    }
    for (const Share& s : shares)
      mass[s.corner.value] += s.mass;
  }

  struct Motion {
    Mat3 R;
    Vec3 from, to;
    Vec3 operator()(const Vec3& X) const { return R * (X - from) + to; }
  };

  Motion match(const std::map<std::uint32_t, double>& masses, const Points& x) const {
    double M = 0;
    Motion motion{Mat3::Zero(), Vec3::Zero(), Vec3::Zero()};
    for (const auto& [c, m] : masses) {
      M += m;
      motion.from += m * rest[c];
      motion.to += m * x[c];
    }
    motion.from /= M;
    motion.to /= M;
    Mat3 A = Mat3::Zero();
    for (const auto& [c, m] : masses)
      A += m * (x[c] - motion.to) * (rest[c] - motion.from).transpose();
    motion.R = material::rotation_of(A);
    return motion;
  }

  /// Of the whole body at once.
  Motion match_all(const Points& x) const {
    std::map<std::uint32_t, double> masses;
    for (std::uint32_t c = 0; c < mass.size(); ++c)
      masses[c] = mass[c];
    return match(masses, x);
  }

  double energy(const double k, const Points& x) const {
    double sum = 0;
    for (const auto& masses : mass_in) {
      const Motion motion = match(masses, x);
      for (const auto& [c, m] : masses)
        sum += 0.5 * k * m * (x[c] - motion(rest[c])).squaredNorm();
    }
    return sum;
  }

  Points goals(const Points& x) const {
    Points g(x.size(), Vec3::Zero());
    for (const auto& masses : mass_in) {
      const Motion motion = match(masses, x);
      for (const auto& [c, m] : masses)
        g[c] += m / mass[c] * motion(rest[c]);
    }
    return g;
  }
};

struct Momentum {
  Vec3 linear = Vec3::Zero(), angular = Vec3::Zero(); ///< about the origin
};

inline Momentum momentum(const std::span<const double> mass, const Points& x, const Points& v) {
  Momentum sum;
  for (std::size_t c = 0; c < mass.size(); ++c) {
    sum.linear += mass[c] * v[c];
    sum.angular += mass[c] * x[c].cross(v[c]);
  }
  return sum;
}

inline double kinetic_energy(const std::span<const double> mass, const Points& v) {
  double sum = 0;
  for (std::size_t c = 0; c < mass.size(); ++c)
    sum += 0.5 * mass[c] * v[c].squaredNorm();
  return sum;
}

inline double largest_difference(const Points& a, const Points& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    largest = std::max(largest, (a[i] - b[i]).norm());
  return largest;
}

} // namespace kerf::lattice
