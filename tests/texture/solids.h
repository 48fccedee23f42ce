#pragma once

/// Solids whose colour is known everywhere, and exemplars cut from them. All are made for a ball of radius 0.05 m
/// around the origin.

#include "tests/geometry/meshes.h"
#include "texture/paint.h"

#include <cmath>
#include <functional>

namespace kerf::texture {

using Solid = std::function<image::Rgb(const Vec3&)>;

inline image::Rgb mixed(const image::Rgb& a, const image::Rgb& b, const double t) {
  const auto s = static_cast<float>(std::clamp(t, 0.0, 1.0));
  return a + s * (b - a);
}

/// From 0 to 1 around x = 0, over a width.
inline double soft_step(const double x, const double width) { return 0.5 + 0.5 * std::tanh(x / width); }

/// Rings around an axis that is not quite z, a little wavy.
inline image::Rgb wood(const Vec3& p) {
  const double wave = 0.003 * std::sin(60 * p[2] + 1) + 0.002 * std::sin(90 * p[0]);
  const double radius = std::hypot(p[0] + 0.15 * p[2] + 0.008, p[1] + wave);
  const double ring = radius / 0.009 - std::floor(radius / 0.009);
  return mixed({0.80f, 0.60f, 0.38f}, {0.45f, 0.26f, 0.12f}, std::pow(ring, 2.5) * soft_step(0.96 - ring, 0.03));
}

/// Ten segments around z with white walls, a pith and a peel.
inline image::Rgb citrus(const Vec3& p) {
  const double r = p.norm(), across = std::hypot(p[0], p[1]), angle = std::atan2(p[1], p[0]);
  const double to_wall = across * std::abs(std::sin(5 * angle)) / 5; // near a wall, its distance
  const double flesh = soft_step(to_wall - 0.0008, 0.0006) * soft_step(0.043 - r, 0.0006) *
                       soft_step(across - 0.006 * std::sqrt(std::max(0.0, 1 - p[2] * p[2] / 0.0025)), 0.0008);
  const image::Rgb white(0.95f, 0.91f, 0.80f), juice(0.95f, 0.55f, 0.10f), peel(0.93f, 0.46f, 0.03f);
  return mixed(mixed(white, juice, flesh), peel, soft_step(r - 0.0475, 0.0006));
}

/// Layers around a point above the middle.
inline image::Rgb onion(const Vec3& p) {
  const double r = Vec3(p[0], p[1], 0.9 * (p[2] - 0.006)).norm();
  const double layer = r / 0.0075 - std::floor(r / 0.0075);
  return mixed({0.93f, 0.88f, 0.90f}, {0.55f, 0.20f, 0.42f}, std::pow(layer, 3) * soft_step(0.95 - layer, 0.04));
}

/// A picture of a solid on the plane through `middle` spanned by two unit vectors, n x n pixels, `half` m to each side.
inline Exemplar exemplar_of(const std::string& name, const Solid& solid, const Vec3& middle, const Vec3& x,
                            const Vec3& y, const int n = 200, const double half = 0.052) {
  const double pixel = 2 * half / (n - 1);
  const SectionPlane plane(middle - half * x - half * y, pixel * x, pixel * y);
  image::Image picture{image::Colours(n, n, image::Rgb::Zero()), {}};
  for (int r = 0; r < n; ++r)
    for (int c = 0; c < n; ++c)
      picture.colours(c, r) = solid(plane.point(plane.to_local(Vec2(c, r))));
  return {name, picture, Background::none, plane};
}

inline geometry::TriangleMesh ball(const int n = 4) { return geometry::sphere_mesh(0.05, Vec3::Zero(), n); }

/// Sections along the axes, from 1 to 9: z = 0, x = 0, y = 0, then z, x, y = -0.024 and +0.024.
inline std::vector<Exemplar> axis_exemplars(const Solid& solid, const int count, const int n = 200) {
  std::vector<Exemplar> exemplars;
  const std::array<double, 3> offsets = {0.0005, -0.024, 0.024};
  for (int i = 0; i < count; ++i) {
    const int axis = (i + 2) % 3;
    exemplars.push_back(exemplar_of("e" + std::to_string(i), solid, offsets[i / 3] * Vec3::Unit(axis),
                                    Vec3::Unit((axis + 1) % 3), Vec3::Unit((axis + 2) % 3), n));
  }
  return exemplars;
}

} // namespace kerf::texture
