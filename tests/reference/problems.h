#pragma once

/// Problems without a closed form, or with one in the limit, for the reference room.

#include "reference/solution.h"

#include <cmath>

namespace kerf::reference {

/// Where one coordinate has a value.
inline Region at(const int axis, const double value) {
  return [=](const Vec3& X) { return std::abs(X[axis] - value) < 1e-9; };
}

/// Cook's trapezium as tests/verification/plates.h has it, in n x n cells.
inline Problem cooks_membrane(const int n) {
  Problem p;
  p.mesh = rectangles(equal(0, 1, n), equal(0, 1, n));
  map_vertices(p.mesh, [](const Vec3& X) { return Vec3(48 * X[0], 44 * X[0] + (44 - 28 * X[0]) * X[1], 0); });
  p.youngs_modulus = 15.0 / 16;
  p.poissons_ratio = 0.25;
  p.supports = {{at(0, 0)}};
  p.tractions = {{at(0, 48), [](const Vec3&, const Vec3&) { return Vec3(0, 1.0 / 16, 0); }}};
  return p;
}

/// The clamped beam of tests/verification/beams.h under its weight, the half with y < 0; n cells, shrinking by 0.3,
/// from each singular edge at the clamp.
inline Problem heavy_cantilever(const int n) {
  Problem p;
  std::vector<double> x = graded(0, 0.2, n + 1, 0.3);
  for (const double more : equal(0.4, 1, 3))
    x.push_back(more);
  const std::vector<double> z = graded_to_both(-0.1, 0.1, n, 0.3);
  const std::vector<double> y(z.begin(), z.begin() + n + 1);
  p.mesh = extruded(rectangles(x, y), z);
  p.youngs_modulus = 1e6;
  p.poissons_ratio = 0.3;
  p.supports = {{at(0, 0)}, {at(1, 0), {false, true, false}}};
  p.body_force = [](const Vec3&) { return Vec3(0, 0, -9810); };
  return p;
}

/// A penny of radius 1 in the middle of a cube of edge 2 R, both of whose ends are pulled by 1 Pa: the quarter x, y >
/// 0, in layers that shrink by 0.15 towards the front. E = 1 Pa, nu = 0.3.
inline Problem penny(const double R, const int n_layers) {
  const std::vector<double> near = graded(0, 0.6, n_layers, 0.15);
  std::vector<double> radii, z;
  for (int i = n_layers; i >= 0; --i)
    radii.push_back(1 - near[static_cast<std::size_t>(i)]);
  for (int i = 1; i <= n_layers; ++i)
    radii.push_back(1 + near[static_cast<std::size_t>(i)]);
  std::vector<double> up = near;
  for (double r = 2.4; r < 0.8 * R; r *= 1.8)
    radii.push_back(r);
  for (double h = 1.2; h < 0.8 * R; h *= 2)
    up.push_back(h);
  up.push_back(R);
  for (std::size_t i = up.size(); i-- > 1;)
    z.push_back(-up[i]);
  z.insert(z.end(), up.begin(), up.end());
  Problem p;
  p.mesh = extruded(quarter_disc_in_square(radii, R), z);
  split(p.mesh, Vec3::Zero(), Vec3::UnitZ(), [](const Vec3& X) { return X.norm() < 1 + 1e-9; });
  p.poissons_ratio = 0.3;
  p.supports = {{at(0, 0), {true, false, false}}, {at(1, 0), {false, true, false}}};
  p.pins = {{Vec3(R, R, -R), {false, false, true}}};
  for (const double end : {-R, R})
    p.tractions.push_back({at(2, end), [](const Vec3&, const Vec3& n) { return n; }});
  return p;
}

/// Volume of its gap over that in a body without end, 16 (1 - nu^2) / 3 (Sneddon 1946).
inline double opened(const Solution& penny) {
  const auto gap = [](const Vec3& X, const Vec3& n, const Vec3& u) { return std::abs(X[2]) < 1e-12 ? -u.dot(n) : 0.0; };
  return 4 * penny.over_skin(gap) / (16 * 0.91 / 3);
}

} // namespace kerf::reference
