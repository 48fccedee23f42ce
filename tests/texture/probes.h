#pragma once

/// What tests of insides measure: points, differences, jumps.

#include "geometry/inside.h"
#include "tests/texture/solids.h"

#include <functional>
#include <random>

namespace kerf::texture {

using Colour = Eigen::Array4f;

/// Points of the ball of radius 0.048 m.
inline Points points_inside(const int n, const unsigned seed, const double radius = 0.048) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> number(-radius, radius);
  Points points;
  while (static_cast<int>(points.size()) < n)
    if (const Vec3 p(number(random), number(random), number(random)); p.norm() < radius)
      points.push_back(p);
  return points;
}

inline double difference(const Colour& a, const Colour& b) { return (a - b).abs().maxCoeff(); }

/// The largest change of a function of points that is left over 2^-30 of a step when the step in which it changes most,
/// among `n_steps` of a way inside of a body, is halved thirty times, always keeping the half that changes more: its
/// largest jump, and nearly nothing where it is continuous.
template <class Function>
double largest_jump(const Function& f, const geometry::Inside& body, const Vec3& from, const Vec3& to,
                    const int n_steps) {
  Vec3 a = from, b = to;
  double most = 0;
  for (int i = 0; i < n_steps; ++i) {
    const Vec3 p = from + double(i) / n_steps * (to - from), q = from + double(i + 1) / n_steps * (to - from);
    if (const double change = difference(f(p), f(q)); change > most && body.contains(p) && body.contains(q)) {
      most = change;
      a = p;
      b = q;
    }
  }
  for (int i = 0; i < 30; ++i) {
    const Vec3 middle = 0.5 * (a + b);
    (difference(f(a), f(middle)) > difference(f(middle), f(b)) ? b : a) = middle;
  }
  return difference(f(a), f(b));
}

/// The same over many ways through a body in the ball.
template <class Function>
double largest_jump(const Function& f, const geometry::TriangleMesh& body, const int n_ways, const int n_steps) {
  const geometry::Inside inside(body);
  const Points ends = points_inside(2 * n_ways, 11);
  double jump = 0;
  for (int i = 0; i < n_ways; ++i)
    jump = std::max(jump, largest_jump(f, inside, ends[2 * i], ends[2 * i + 1], n_steps));
  return jump;
}

/// How far the colours of an interior are from its exemplars' on their own planes, away from the skin, and from other
/// planes, where round-off decides which of two pictures counts.
inline double largest_error_on_exemplars(const Interior& inside, const Blending& how, const double radius = 0.046) {
  double largest = 0;
  for (const Chart& chart : inside.charts())
    for (int r = 10; r < chart.inside.height; r += 7)
      for (int c = 10; c < chart.inside.width; c += 7) {
        const Vec3 p = chart.plane.point(chart.plane.to_local(Vec2(c, r)));
        bool counts = p.norm() < radius && chart.inside(c, r) > 0.5f && chart.shown(c, r) > 0.5f;
        for (const Chart& other : inside.charts())
          counts &= &other == &chart || std::abs(other.plane.height(p)) > 1e-3;
        if (counts)
          largest = std::max(largest, difference(inside.colour(p, how), chart.colours(c, r)));
      }
  return largest;
}

} // namespace kerf::texture
