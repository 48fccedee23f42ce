#pragma once

/// The same physical section, stored in another way.

#include "image/spline.h"
#include "texture/exemplar.h"

#include <cmath>

namespace kerf::texture {

/// Pixel (c, r) of the result is pixel of(c, r) of the exemplar; the plane goes along.
template <class Of>
Exemplar restored(const Exemplar& e, const int width, const int height, const Of& of) {
  const auto at = [&](const int c, const int r) { return Vec3(e.plane.point(e.plane.to_local(of(c, r)))); };
  Exemplar result = e;
  result.plane = SectionPlane(at(0, 0), at(1, 0) - at(0, 0), at(0, 1) - at(0, 0));
  result.picture.colours = image::Colours(width, height, image::Rgb::Zero());
  if (e.picture.has_alpha())
    result.picture.alpha = image::Grey(width, height, 0);
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c) {
      const Vec2 p = of(c, r);
      const int i = static_cast<int>(std::lround(p[0])), j = static_cast<int>(std::lround(p[1]));
      result.picture.colours(c, r) = e.picture.colours(i, j);
      if (e.picture.has_alpha())
        result.picture.alpha(c, r) = e.picture.alpha(i, j);
    }
  return result;
}

inline Exemplar turned(const Exemplar& e) {
  const int w = e.picture.width(), h = e.picture.height();
  return restored(e, h, w, [&](const int c, const int r) { return Vec2(w - 1 - r, c); });
}
inline Exemplar mirrored(const Exemplar& e) {
  const int w = e.picture.width(), h = e.picture.height();
  return restored(e, w, h, [&](const int c, const int r) { return Vec2(w - 1 - c, r); });
}

/// Turned by any angle, pixels between pixels.
inline Exemplar turned_by(const Exemplar& e, const double angle) {
  const double w = e.picture.width(), h = e.picture.height();
  const int n = static_cast<int>(std::ceil(std::hypot(w, h)));
  const Vec2 middle(0.5 * (w - 1), 0.5 * (h - 1)), u(std::cos(angle), std::sin(angle)), v(-u[1], u[0]);
  const auto of = [&](const double c, const double r) {
    return Vec2(middle + (c - 0.5 * (n - 1)) * u + (r - 0.5 * (n - 1)) * v);
  };
  const auto at = [&](const Vec2& p) { return Vec3(e.plane.point(e.plane.to_local(p))); };
  const image::Colours spline = image::spline_coefficients(e.picture.colours);
  Exemplar result = e;
  result.plane = SectionPlane(at(of(0, 0)), at(of(1, 0)) - at(of(0, 0)), at(of(0, 1)) - at(of(0, 0)));
  result.picture.colours = image::Colours(n, n, image::Rgb::Zero());
  result.picture.alpha = image::Grey(n, n, 0);
  for (int r = 0; r < n; ++r)
    for (int c = 0; c < n; ++c) {
      const Vec2 p = of(c, r);
      if (p[0] < 0 || p[1] < 0 || p[0] > w - 1 || p[1] > h - 1)
        continue;
      const auto x = static_cast<float>(p[0]), y = static_cast<float>(p[1]);
      result.picture.colours(c, r) = image::sample_spline(spline, x, y).max(0.0f).min(1.0f);
      result.picture.alpha(c, r) = e.picture.has_alpha() ? image::sample(e.picture.alpha, x, y) : 1.0f;
    }
  result.background = Background::alpha;
  return result;
}

} // namespace kerf::texture
