#pragma once

/// Strokes of any kind through bodies that swing.

#include "cut/blade.h"
#include "tests/support/placed.h"

#include <Eigen/Geometry>

#include <cmath>

namespace kerf::cut {

using support::Body;

/// A stroke from a random place beside a body of this size into it and on, which turns on its way, and whose edge ends
/// somewhere in it.
inline Blade random_stroke(support::Random& random, const double size) {
  const Vec3 towards = support::random_direction(random), side = towards.unitOrthogonal();
  const Vec3 start = -1.3 * size * towards + 0.4 * size * support::random_vector(random);
  const double reach = support::uniform(random, 0.6, 2.4), turn = support::uniform(random, -60, 60);
  Blade blade = {
    "blade", {Vec3(support::uniform(random, -1.5, 0) * size * side), Vec3(support::uniform(random, 0, 1.5) * size * side)}, {}};
  blade.key_frames = {{0, start, Vec3::Zero()}, {1, start + reach * size * towards, turn * side}};
  return blade;
}

/// A body in waves.
inline Points swung(const Body& body, const double height, const double t) {
  Points x = grid::rest_positions(body);
  for (Vec3& p : x)
    p += height * Vec3(std::sin(0.4 * p[1] + 5 * t), std::sin(0.3 * p[2] + 4 * t), std::sin(0.5 * p[0] + 6 * t));
  return x;
}

} // namespace kerf::cut
