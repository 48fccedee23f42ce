#include "texture/section_pixels.h"

#include "image/filters.h"
#include "texture/exemplar.h"

#include <Eigen/Geometry>

namespace kerf::texture {

namespace {

constexpr double margin = 3; ///< pixels around a section

struct Box {
  Vec2 lower = Vec2::Constant(1e300), upper = Vec2::Constant(-1e300);
  void add(const Vec2& p) {
    lower = lower.cwiseMin(p);
    upper = upper.cwiseMax(p);
  }
  PixelBox in_whole_pixels() const {
    return {(lower.array().floor() - margin).matrix(), (upper.array().ceil() + margin).matrix()};
  }
};

/// Whatever the order and sense of its segments: the mean of an outline's points, and their spread as that of a line.
struct Spread {
  Vec2 mean = Vec2::Zero();
  Mat2 square = Mat2::Zero(); ///< mean of (p - mean)(p - mean)^T
};

Spread spread_of(const std::vector<Segment>& outline) {
  Spread spread;
  double length = 0;
  for (const auto& [a, b] : outline) {
    spread.mean += (b - a).norm() * 0.5 * (a + b);
    length += (b - a).norm();
  }
  spread.mean /= length;
  for (const auto& [a, b] : outline) {
    const Vec2 along = b - a, middle = 0.5 * (a + b) - spread.mean;
    spread.square += along.norm() / length * (middle * middle.transpose() + along * along.transpose() / 12);
  }
  return spread;
}

/// The unit vector along which an outline is longest, on the side of `x`; `x` where it is as long all around.
Vec2 longest(const std::vector<Segment>& outline, const Vec2& x) {
  constexpr double least = 0.02; // below, round-off decides
  const Mat2 square = spread_of(outline).square;
  const Vec2 twice(square(0, 0) - square(1, 1), 2 * square(0, 1));
  if (twice.norm() < least * square.trace())
    return x;
  const double angle = 0.5 * std::atan2(twice[1], twice[0]);
  const Vec2 along(std::cos(angle), std::sin(angle));
  return along.dot(x) < 0 ? Vec2(-along) : along;
}

} // namespace

std::vector<Segment> in_pixels(const std::vector<Segment>& outline, const SectionPlane& plane) {
  std::vector<Segment> result;
  for (const Segment& segment : outline)
    result.push_back({plane.to_pixels(segment[0]), plane.to_pixels(segment[1])});
  return result;
}

PixelBox box_of(const std::vector<Segment>& outline, const SectionPlane& plane) {
  Box box;
  for (const Segment& segment : outline)
    for (const Vec2& p : segment)
      box.add(plane.to_pixels(p));
  return box.in_whole_pixels();
}

SectionPlane moved(const SectionPlane& plane, const Vec2& first) {
  const auto at = [&](const Vec2& pixel) { return Vec3(plane.point(plane.to_local(pixel))); };
  return {at(first), at(first + Vec2(1, 0)) - at(first), at(first + Vec2(0, 1)) - at(first)};
}

Vec2 pixels_of(const SectionPlane& plane, const SectionPlane& from, const Vec2& pixel) {
  return plane.to_pixels(plane.local(from.point(from.to_local(pixel))));
}

SectionPlane along_section(const std::vector<Segment>& outline, const SectionPlane& plane, const Mat3& body_axes) {
  const Vec3 own = in_plane(body_axes, plane.normal());
  const Vec2 x = longest(outline, Vec2(plane.x().dot(own), plane.y().dot(own)).normalized());
  const Vec2 y = sense(body_axes, plane.normal()) * Vec2(-x[1], x[0]);
  Box box;
  for (const Segment& segment : outline)
    for (const Vec2& p : segment)
      box.add(Vec2(x.dot(p), y.dot(p)));
  const Vec2 middle = 0.5 * (box.lower + box.upper), half = 0.5 * (box.upper - box.lower);
  // The box ends midway between pixels: where it ended on them, round-off would say which are in.
  constexpr double rounding = 1e-6;
  const Vec2 n = (half.array() / plane.pixel() - 0.5 - rounding).ceil().max(1.0) + 0.5;
  const auto step = [&](const double length, const Vec2& to) {
    return Vec3(length * (to[0] * plane.x() + to[1] * plane.y()));
  };
  return {plane.point(middle[0] * x + middle[1] * y), step(half[0] / n[0], x), step(half[1] / n[1], y)};
}

Relaid relaid(const image::Grey& mask, const SectionPlane& plane, const SectionPlane& pixels) {
  Box box;
  for (const double column : {0, mask.width - 1})
    for (const double row : {0, mask.height - 1})
      box.add(pixels_of(pixels, plane, Vec2(column, row)));
  const PixelBox whole = box.in_whole_pixels();
  constexpr int around = 4;
  constexpr float enough = 0.499f; // a border midway between pixels is no matter of round-off
  // The steps of one lattice are not those of another.
  const image::Grey smooth = image::blurred(image::padded(mask, around), 1);
  Relaid result{image::Grey(whole.width(), whole.height(), 0), moved(pixels, whole.lower)};
  for (int r = 0; r < whole.height(); ++r)
    for (int c = 0; c < whole.width(); ++c) {
      const Vec2 p = pixels_of(plane, result.plane, Vec2(c, r)) + Vec2::Constant(around);
      result.mask(c, r) =
        image::sample(smooth, static_cast<float>(p[0]), static_cast<float>(p[1])) >= enough ? 1.0f : 0.0f;
    }
  return result;
}

} // namespace kerf::texture
