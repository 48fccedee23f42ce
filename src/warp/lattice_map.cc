#include "warp/lattice_map.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace kerf::warp {

namespace {

/// A point in its cell: the lowest node, and how far along the cell [1].
struct Place {
  int column, row;
  double u, v;
};

Place place(const LatticeMap& map, const Vec2& p) {
  const Vec2 q = (p - map.lower).cwiseQuotient(map.spacing());
  const int column = std::clamp(static_cast<int>(std::floor(q[0])), 0, map.n_columns - 2);
  const int row = std::clamp(static_cast<int>(std::floor(q[1])), 0, map.n_rows - 2);
  return {column, row, q[0] - column, q[1] - row};
}

Vec2 clamped(const LatticeMap& map, const Vec2& p) { return p.cwiseMax(map.lower).cwiseMin(map.upper); }

/// Newton's method on the bilinear pieces, kept within a cell of the rectangle.
Vec2 newton(const LatticeMap& map, const Vec2& target, Vec2 p, const int n_steps) {
  const Vec2 margin = map.spacing();
  for (int i = 0; i < n_steps; ++i) {
    const Vec2 error = map(p) - target;
    const Mat2 gradient = map.gradient(p);
    if (std::abs(gradient.determinant()) < 1e-300)
      return p;
    const Vec2 step = gradient.inverse() * error;
    p = (p - step).cwiseMax(map.lower - margin).cwiseMin(map.upper + margin);
    if (step.cwiseQuotient(margin).norm() < 1e-12)
      break;
  }
  return p;
}

bool solves(const LatticeMap& map, const Vec2& target, const Vec2& p, const double scale) {
  return (map(p) - target).norm() <= 1e-9 * scale;
}

/// How large the image of a cell is, for tolerances.
double image_scale(const LatticeMap& map) {
  return (map.node(map.n_columns - 1, map.n_rows - 1) - map.node(0, 0)).norm() + 1e-300;
}

} // namespace

Vec2 LatticeMap::operator()(const Vec2& p) const {
  const auto [c, r, u, v] = place(*this, p);
  return (1 - v) * ((1 - u) * node(c, r) + u * node(c + 1, r)) +
         v * ((1 - u) * node(c, r + 1) + u * node(c + 1, r + 1));
}

Mat2 LatticeMap::gradient(const Vec2& p) const {
  const auto [c, r, u, v] = place(*this, p);
  const Vec2 h = spacing();
  Mat2 g;
  g.col(0) = ((1 - v) * (node(c + 1, r) - node(c, r)) + v * (node(c + 1, r + 1) - node(c, r + 1))) / h[0];
  g.col(1) = ((1 - u) * (node(c, r + 1) - node(c, r)) + u * (node(c + 1, r + 1) - node(c + 1, r))) / h[1];
  return g;
}

Affine Affine::inverse() const {
  const Mat2 back = linear.inverse();
  return {back, -(back * shift)};
}

double smallest_determinant(const LatticeMap& map, const Mat2& reference) {
  const Vec2 h = map.spacing();
  double smallest = 1e300;
  for (int r = 0; r + 1 < map.n_rows; ++r)
    for (int c = 0; c + 1 < map.n_columns; ++c)
      for (const int dr : {0, 1})
        for (const int dc : {0, 1}) {
          Mat2 gradient;
          gradient.col(0) = (map.node(c + 1, r + dr) - map.node(c, r + dr)) / h[0];
          gradient.col(1) = (map.node(c + dc, r + 1) - map.node(c + dc, r)) / h[1];
          smallest = std::min(smallest, gradient.determinant());
        }
  return smallest / reference.determinant();
}

std::optional<Vec2> inverse_at(const LatticeMap& map, const Vec2& target, const Vec2& start) {
  const double scale = image_scale(map);
  const Vec2 margin = 1e-6 * map.spacing();
  const auto is_inside = [&](const Vec2& p) { return (clamped(map, p) - p).cwiseQuotient(margin).norm() <= 1; };
  const Vec2 p = newton(map, target, start, 30);
  if (solves(map, target, p, scale) && is_inside(p))
    return clamped(map, p);
  for (int r = 0; r + 1 < map.n_rows; ++r)
    for (int c = 0; c + 1 < map.n_columns; ++c) {
      const Vec2 q = newton(map, target, 0.5 * (map.source(c, r) + map.source(c + 1, r + 1)), 8);
      if (solves(map, target, q, scale) && is_inside(q))
        return clamped(map, q);
    }
  return std::nullopt;
}

LatticeMap inverse(const LatticeMap& map, const Vec2& lower, const Vec2& upper, const int n_columns, const int n_rows) {
  Vec2 last = 0.5 * (map.lower + map.upper);
  return lattice_of(
    [&](const Vec2& target) {
      const auto found = inverse_at(map, target, last);
      last = found ? *found : newton(map, target, last, 30);
      return last;
    },
    lower, upper, n_columns, n_rows);
}

} // namespace kerf::warp
