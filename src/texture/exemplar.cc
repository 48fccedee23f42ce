#include "texture/exemplar.h"

#include "base/error.h"
#include "image/filters.h"
#include "image/spline.h"
#include "texture/outline.h"
#include "texture/section_pixels.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace kerf::texture {

namespace {

using image::Grey;

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
  const image::Colours there = image::spline_coefficients(image::filled(picture.colours, mask));
  image::Colours colours(width, height, image::Rgb::Zero());
  chart.shown = Grey(width, height, 0);
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c) {
      const Vec2 p = to_picture(Vec2(c, r));
      const bool is_in = p[0] >= -0.5 && p[1] >= -0.5 && p[0] <= mask.width - 0.5 && p[1] <= mask.height - 0.5;
      const auto x = static_cast<float>(p[0]), y = static_cast<float>(p[1]);
      colours(c, r) = image::sample_spline(there, x, y).max(0.0f).min(1.0f);
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

double sense(const Mat3& axes, const Vec3& v) { return (axes * Vec3(0.8, 0.5, 0.33)).dot(v) < 0 ? -1 : 1; }

Chart make_chart(const Exemplar& exemplar, const geometry::TriangleMesh& body,
                 const std::optional<warp::LatticeMap>& known, std::optional<warp::LatticeMap>& used) {
  const Grey mask = mask_of(exemplar.picture, exemplar.background);
  const SectionPlane& plane = exemplar.plane;
  const Mat3 axes = axes_of(body);
  const std::vector<Segment> section = slice(body, frame_of(plane));
  if (section.empty())
    throw ParameterError(Complaint{.path = "Origin [m]",
                                   .rule = "the plane of this exemplar misses the body",
                                   .remedy = "Move the plane into the body, rest frame"});
  const SectionPlane lattice = exemplar.fit == Fit::none ? plane : along_section(section, plane, axes);
  const PixelBox box = box_of(slice(body, frame_of(lattice)), lattice);
  check_size(box);
  Chart chart{moved(lattice, box.lower), {}, {}, {}, {}, {}, {}, 1, {}, axes};
  chart.outline = slice(body, frame_of(chart.plane));
  chart.inside = inside_of(in_pixels(chart.outline, chart.plane), box.width(), box.height());
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
  const Relaid picture = relaid(mask, plane, chart.plane);
  const Outlines outlines = outlines_of(chart.inside, picture.mask);
  const auto inside = exemplar.fit == Fit::rigid ? warp::Regularity::rigid : warp::Regularity::jacobian;
  used = known ? *known : fitted(outlines, {.inside = inside});
  chart.fit_error = gap_after(*used, outlines);
  paint(
    exemplar.picture, mask, [&](const Vec2& p) { return pixels_of(plane, picture.plane, (*used)(p)); }, chart);
  return chart;
}

} // namespace kerf::texture
