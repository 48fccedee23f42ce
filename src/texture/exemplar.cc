#include "texture/exemplar.h"

#include "base/error.h"
#include "image/filters.h"
#include "image/spline.h"
#include "texture/outline.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace kerf::texture {

namespace {

using image::Grey;

constexpr double margin = 3; ///< pixels around the section

/// The box of the body's section, in pixels of the picture.
struct PixelBox {
  Vec2 lower = Vec2::Constant(1e300), upper = Vec2::Constant(-1e300);
};

std::vector<Segment> in_pixels(const std::vector<Segment>& outline, const SectionPlane& plane) {
  std::vector<Segment> result;
  for (const Segment& segment : outline)
    result.push_back({plane.to_pixels(segment[0]), plane.to_pixels(segment[1])});
  return result;
}

PixelBox box_of(const std::vector<Segment>& curves) {
  PixelBox box;
  for (const Segment& segment : curves)
    for (const Vec2& p : segment) {
      box.lower = box.lower.cwiseMin(p);
      box.upper = box.upper.cwiseMax(p);
    }
  box.lower = (box.lower.array().floor() - margin).matrix();
  box.upper = (box.upper.array().ceil() + margin).matrix();
  return box;
}

void check_size(const PixelBox& box) {
  constexpr double most = 8192;
  if ((box.upper - box.lower).maxCoeff() > most)
    throw ParameterError(Complaint{.path = "Column [m]",
                                   .rule = "pixels are so small that the body's section spans more than 8192 of them",
                                   .remedy = "Check the unit, or take a coarser picture"});
}

/// Fills colours and what is shown: chart pixel (c, r) shows the picture at to_picture(c, r).
template <class ToPicture>
void paint(const image::Image& picture, const Grey& mask, const ToPicture& to_picture, Chart& chart) {
  const int width = chart.inside.width, height = chart.inside.height;
  const image::Colours there = image::filled(picture.colours, mask);
  image::Colours colours(width, height, image::Rgb::Zero());
  chart.shown = Grey(width, height, 0);
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c) {
      const Vec2 p = to_picture(Vec2(c, r));
      const bool is_in = p[0] >= -0.5 && p[1] >= -0.5 && p[0] <= mask.width - 0.5 && p[1] <= mask.height - 0.5;
      const auto x = static_cast<float>(p[0]), y = static_cast<float>(p[1]);
      colours(c, r) = image::sample(there, x, y);
      chart.shown(c, r) = is_in && image::sample(mask, x, y) >= 0.5f ? 1.0f : 0.0f;
    }
  double n_inside = 0, n_shown = 0;
  for (std::size_t i = 0; i < chart.shown.values.size(); ++i) {
    n_inside += chart.inside.values[i];
    n_shown += chart.inside.values[i] * chart.shown.values[i];
  }
  chart.shown_share = n_shown / n_inside;
  colours = image::filled(colours, chart.shown);
  chart.colours = image::Raster<Eigen::Array4f>(width, height, Eigen::Array4f::Zero());
  for (std::size_t i = 0; i < colours.values.size(); ++i) {
    const image::Rgb& rgb = colours.values[i];
    chart.colours.values[i] = Eigen::Array4f(rgb[0], rgb[1], rgb[2], image::luminance(rgb));
  }
  chart.spline = image::spline_coefficients(chart.colours);
  chart.luminance = image::luminance(colours);
}

} // namespace

Mat3 axes_of(const geometry::TriangleMesh& body) {
  const Triangle& t = body.triangles.front();
  const Vec3 u = body.vertices[t[1]] - body.vertices[t[0]], v = body.vertices[t[2]] - body.vertices[t[0]];
  Mat3 axes;
  axes.col(0) = u.normalized();
  axes.col(2) = axes.col(0).unitOrthogonal(); // where the triangle has no area
  if (const Vec3 normal = u.cross(v); normal.norm() > 1e-9 * u.norm() * v.norm())
    axes.col(2) = normal.normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return axes;
}

Vec3 in_plane(const Mat3& axes, const Vec3& normal) {
  const Vec3 axis = std::abs(normal.dot(axes.col(0))) < 0.9 ? axes.col(0) : axes.col(1);
  return (axis - normal.dot(axis) * normal).normalized();
}

Chart make_chart(const Exemplar& exemplar, const geometry::TriangleMesh& body,
                 const std::optional<warp::LatticeMap>& known, std::optional<warp::LatticeMap>& used) {
  const Grey mask = mask_of(exemplar.picture, exemplar.background);
  const SectionPlane& plane = exemplar.plane;
  const auto curves = in_pixels(slice(body, frame_of(plane)), plane);
  if (curves.empty())
    throw ParameterError(Complaint{.path = "Origin [m]",
                                   .rule = "the plane of this exemplar misses the body",
                                   .remedy = "Move the plane into the body, rest frame"});
  const PixelBox box = box_of(curves);
  check_size(box);
  std::vector<Segment> shifted;
  for (const Segment& segment : curves)
    shifted.push_back({segment[0] - box.lower, segment[1] - box.lower});
  const Vec2 size = box.upper - box.lower;
  const auto step = [&](const Vec2& pixels) { return Vec3(plane.point(plane.to_local(pixels))); };
  Chart chart{SectionPlane(step(box.lower), step(box.lower + Vec2(1, 0)) - step(box.lower),
                           step(box.lower + Vec2(0, 1)) - step(box.lower)),
              {},
              {},
              {},
              {},
              inside_of(shifted, static_cast<int>(size[0]) + 1, static_cast<int>(size[1]) + 1),
              {},
              1,
              {},
              axes_of(body)};
  chart.outline = slice(body, frame_of(chart.plane));
  used.reset();
  if (std::accumulate(chart.inside.values.begin(), chart.inside.values.end(), 0.0) < 16)
    throw ParameterError(Complaint{.path = "Column [m]",
                                   .rule = "the body's section is smaller than 16 pixels of this exemplar",
                                   .remedy = "Check the unit of the steps, or take a finer picture"});
  if (exemplar.fit == Fit::none) {
    paint(
      exemplar.picture, mask, [&](const Vec2& p) { return Vec2(p + box.lower); }, chart);
    return chart;
  }
  const Outlines outlines = outlines_of(chart.inside, mask);
  const auto inside = exemplar.fit == Fit::rigid ? warp::Regularity::rigid : warp::Regularity::jacobian;
  used = known ? *known : fitted(outlines, {.inside = inside});
  chart.fit_error = gap_after(*used, outlines);
  paint(exemplar.picture, mask, *used, chart);
  return chart;
}

} // namespace kerf::texture
