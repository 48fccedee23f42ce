#include "texture/warps.h"

#include "base/error.h"
#include "image/filters.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace kerf::texture {

namespace {

using image::Grey;

Vec3 inward(const Face& face, const Chart& chart) { return face.side * chart.plane.normal(); }

Vec2 along(const Aligned& aligned, const Vec3& p) { return Vec2(aligned.a.dot(p), aligned.b.dot(p)); }

/// The box of a face along two axes, from the middles of its pixels, at least some pixels wide.
void find_box(const Face& face, const Chart& chart, Aligned& aligned) {
  Vec2 lower = Vec2::Constant(1e300), upper = Vec2::Constant(-1e300);
  for (int r = 0; r < face.pixels.height; ++r)
    for (int c = 0; c < face.pixels.width; ++c)
      if (face.pixels(c, r) > 0.5f) {
        const Vec2 p = along(aligned, chart.plane.point(chart.plane.to_local(Vec2(c, r))));
        lower = lower.cwiseMin(p);
        upper = upper.cwiseMax(p);
      }
  const Vec2 half = (0.5 * (upper - lower)).cwiseMax(2 * chart.plane.pixel());
  aligned.lower = 0.5 * (lower + upper) - half;
  aligned.size = 2 * half;
}

/// From aligned coordinates to pixels of the chart: the plane's height along its normal is fixed.
warp::Affine to_chart(const Aligned& aligned, const Chart& chart) {
  const SectionPlane& plane = chart.plane;
  Mat2 local; // aligned axes in the plane's coordinates
  local << plane.x().dot(aligned.a), plane.x().dot(aligned.b), plane.y().dot(aligned.a), plane.y().dot(aligned.b);
  const Vec2 origin = along(aligned, plane.origin());
  const Mat2 linear = plane.pixels_by_local() * local;
  return {linear, -(linear * origin)};
}

/// From pixels of the matched pictures to aligned coordinates.
warp::Affine from_raster(const Aligned& aligned, const AlignedPair& pair) {
  Mat2 scale = Mat2::Zero();
  scale(0, 0) = aligned.size[0] / (pair.width - 1);
  scale(1, 1) = aligned.size[1] / (pair.height - 1);
  return {scale, aligned.lower};
}

warp::Affine after(const warp::Affine& second, const warp::Affine& first) {
  return {second.linear * first.linear, second.linear * first.shift + second.shift};
}

/// From pixels of the matched pictures to pixels of the chart.
warp::Affine raster_to_chart(const Aligned& aligned, const AlignedPair& pair, const Chart& chart) {
  return after(to_chart(aligned, chart), from_raster(aligned, pair));
}

warp::Picture picture_of(const Face& face, const Chart& chart, const Aligned& aligned, const AlignedPair& pair) {
  const warp::Affine place = raster_to_chart(aligned, pair, chart);
  warp::Picture picture{image::Colours(pair.width, pair.height, image::Rgb::Zero()), Grey(pair.width, pair.height, 0)};
  for (int r = 0; r < pair.height; ++r)
    for (int c = 0; c < pair.width; ++c) {
      const Vec2 p = place(Vec2(c, r));
      const auto x = static_cast<float>(p[0]), y = static_cast<float>(p[1]);
      picture.colours(c, r) = image::sample(chart.colours, x, y).head<3>();
      const bool is_in = x >= 0 && y >= 0 && p[0] <= face.pixels.width - 1 && p[1] <= face.pixels.height - 1;
      picture.mask(c, r) = is_in ? image::sample(face.pixels, x, y) : 0.0f;
    }
  picture.colours = image::filled(picture.colours, picture.mask);
  return picture;
}

bool is_in(const Face& face, const Chart& chart, const Vec3& p) {
  const Vec2 pixel = chart.plane.to_pixels(chart.plane.local(p));
  const int c = static_cast<int>(std::lround(pixel[0])), r = static_cast<int>(std::lround(pixel[1]));
  return c >= 0 && r >= 0 && c < face.pixels.width && r < face.pixels.height && face.pixels(c, r) > 0.5f;
}

/// In which direction a face is longest, bright pixels counting more: a vector at twice the angle from x [1], shorter
/// than 1, of no length for what is as long in all directions. Nothing of how the picture is stored is in it.
Vec2 elongation(const Face& face, const Chart& chart, const Vec3& x, const Vec3& y) {
  Vec2 sum = Vec2::Zero();
  double area = 0;
  const auto each_pixel = [&](const auto& use) {
    for (int r = 0; r < face.pixels.height; ++r)
      for (int c = 0; c < face.pixels.width; ++c)
        if (face.pixels(c, r) > 0.5f) {
          const Vec3 p = chart.plane.point(chart.plane.to_local(Vec2(c, r)));
          use(Vec2(x.dot(p), y.dot(p)), 0.5 + chart.colours(c, r)[3]);
        }
  };
  each_pixel([&](const Vec2& p, double) {
    sum += p;
    area += 1;
  });
  const Vec2 middle = sum / area;
  Vec2 twice = Vec2::Zero();
  double all = 0;
  each_pixel([&](const Vec2& p, const double weight) {
    const Vec2 d = p - middle;
    twice += weight * Vec2(d[0] * d[0] - d[1] * d[1], 2 * d[0] * d[1]);
    all += weight * d.squaredNorm();
  });
  return twice / all;
}

/// The axis along which the boxes of two parallel faces lie: where the two together are longest; along the body's own
/// axis where they are as long in all directions.
Vec3 longest_axis(const Face& from, const Chart& from_chart, const Face& to, const Chart& to_chart) {
  constexpr double least = 0.02; // below, pixels decide
  const Vec3 x = in_plane(from_chart.body_axes, from_chart.plane.normal()), y = from_chart.plane.normal().cross(x);
  const Vec2 twice = elongation(from, from_chart, x, y) + elongation(to, to_chart, x, y);
  const double angle = twice.norm() < least ? 0 : 0.5 * std::atan2(twice[1], twice[0]);
  return std::cos(angle) * x + std::sin(angle) * y;
}

/// A pin as seen from two faces: which of its ends lies on the first; -1 if it does not join them.
int first_end(const ExemplarPin& pin, const std::string& from, const std::string& to) {
  return pin.exemplars[0] == from && pin.exemplars[1] == to   ? 0
         : pin.exemplars[1] == from && pin.exemplars[0] == to ? 1
                                                              : -1;
}

/// The same where both points lie in the faces; else -1.
int joining_end(const ExemplarPin& pin, const Face& from, const Face& to, const std::vector<Exemplar>& exemplars,
                const std::vector<Chart>& charts) {
  const int end = first_end(pin, exemplars[from.exemplar].name, exemplars[to.exemplar].name);
  return end >= 0 && is_in(from, charts[from.exemplar], pin.points[end]) &&
             is_in(to, charts[to.exemplar], pin.points[1 - end])
           ? end
           : -1;
}

} // namespace

AlignedPair align(const Face& from, const Chart& from_chart, const Face& to, const Chart& to_chart, const int pixels) {
  const Vec3 m = inward(from, from_chart), n = inward(to, to_chart);
  const Vec3 shared = m.cross(n);
  AlignedPair pair;
  const Vec3 axis = shared.norm() > 1e-3 ? Vec3(shared.normalized()) : longest_axis(from, from_chart, to, to_chart);
  pair.from.a = sense(from_chart.body_axes, axis) * axis;
  pair.to.a = (pair.from.a - n.dot(pair.from.a) * n).normalized();
  pair.from.b = m.cross(pair.from.a);
  pair.to.b =
    from.exemplar == to.exemplar ? pair.from.b : Vec3((-n).cross(pair.to.a)); // components of one: as they lie
  const double sense_of_b = sense(from_chart.body_axes, pair.from.b + pair.to.b);
  pair.from.b *= sense_of_b;
  pair.to.b *= sense_of_b;
  find_box(from, from_chart, pair.from);
  find_box(to, to_chart, pair.to);
  const Vec2 size = 0.5 * (pair.from.size / from_chart.plane.pixel() + pair.to.size / to_chart.plane.pixel());
  const double scale = std::min(1.0, pixels / size.maxCoeff());
  pair.width = std::max(16, static_cast<int>(std::lround(scale * size[0])));
  pair.height = std::max(16, static_cast<int>(std::lround(scale * size[1])));
  return pair;
}

bool are_partners(const Face& from, const Face& to, const std::vector<Exemplar>& exemplars,
                  const std::vector<Chart>& charts, const WarpOptions& options) {
  const Chart &a = charts[from.exemplar], &b = charts[to.exemplar];
  return options.partners == Partners::all || inward(from, a).dot(inward(to, b)) < -0.7 ||
         std::any_of(options.pins.begin(), options.pins.end(),
                     [&](const ExemplarPin& pin) { return joining_end(pin, from, to, exemplars, charts) >= 0; });
}

Mat2 aligned_linear(const AlignedPair& pair, const Chart& from, const Chart& to) {
  return raster_to_chart(pair.to, pair, to).linear * raster_to_chart(pair.from, pair, from).linear.inverse();
}

BothWays match_faces(const Face& from, const Chart& from_chart, const Face& to, const Chart& to_chart,
                     const AlignedPair& pair, const warp::MatchOptions& options) {
  const warp::Picture a = picture_of(from, from_chart, pair.from, pair), b = picture_of(to, to_chart, pair.to, pair);
  return warp::match(a, b, options);
}

namespace {

/// The pins between two faces, in pixels of the matched pictures.
std::vector<warp::Pin> pins_between(const Face& from, const Face& to, const std::vector<Exemplar>& exemplars,
                                    const std::vector<Chart>& charts, const AlignedPair& pair,
                                    const std::vector<ExemplarPin>& all) {
  std::vector<warp::Pin> pins;
  for (const ExemplarPin& pin : all)
    if (const int end = joining_end(pin, from, to, exemplars, charts); end >= 0)
      pins.push_back({from_raster(pair.from, pair).inverse()(along(pair.from, pin.points[end])),
                      from_raster(pair.to, pair).inverse()(along(pair.to, pin.points[1 - end]))});
  return pins;
}

WarpTable empty_table(const Face& face, const int n_faces) {
  constexpr double pixels_a_node = 3;
  int left = face.pixels.width, right = 0, top = face.pixels.height, bottom = 0;
  for (int r = 0; r < face.pixels.height; ++r)
    for (int c = 0; c < face.pixels.width; ++c)
      if (face.pixels(c, r) > 0.5f) {
        left = std::min(left, c);
        right = std::max(right, c);
        top = std::min(top, r);
        bottom = std::max(bottom, r);
      }
  const auto n_nodes = [](const int length) {
    return std::max(2, static_cast<int>(std::ceil(length / pixels_a_node)) + 1);
  };
  const int width = std::max(1, right - left), height = std::max(1, bottom - top);
  WarpTable table{n_nodes(width),
                  n_nodes(height),
                  (2 * n_faces + 3) / 4 * 4,
                  static_cast<float>(left),
                  static_cast<float>(top),
                  0,
                  0,
                  {}};
  table.columns_by_pixel = static_cast<float>(table.n_columns - 1) / static_cast<float>(width);
  table.rows_by_pixel = static_cast<float>(table.n_rows - 1) / static_cast<float>(height);
  table.targets.assign(static_cast<std::size_t>(table.n_numbers) * table.n_columns * table.n_rows, 0.0f);
  return table;
}

/// Puts a map of matched pictures into the table of its source face.
void fill(WarpTable& table, const int target, const warp::LatticeMap& map, const warp::Affine& from,
          const warp::Affine& to) {
  const warp::Affine back = from.inverse();
  for (int r = 0; r < table.n_rows; ++r)
    for (int c = 0; c < table.n_columns; ++c) {
      const Vec2 pixel(table.left + c / table.columns_by_pixel, table.top + r / table.rows_by_pixel);
      const Vec2 image = to(map(back(pixel)));
      float* const place = &table.targets[table.n_numbers * (r * table.n_columns + c) + 2 * target];
      place[0] = static_cast<float>(image[0]);
      place[1] = static_cast<float>(image[1]);
    }
}

/// The ends of a pin lie on the planes of its exemplars, to a pixel.
void check_planes(const ExemplarPin& pin, const std::vector<Exemplar>& exemplars, const std::vector<Chart>& charts) {
  for (std::size_t i = 0; i < exemplars.size(); ++i)
    for (const int end : {0, 1}) {
      const SectionPlane& plane = charts[i].plane;
      const double height = plane.height(pin.points[end]);
      if (exemplars[i].name != pin.exemplars[end] || std::abs(height) <= plane.pixel())
        continue;
      std::ostringstream rule;
      rule << "the pinned point lies " << std::abs(height) << " m off the plane of exemplar " << exemplars[i].name;
      throw ParameterError(Complaint{.path = end == 0 ? "From [m]" : "To [m]",
                                     .value = "pin " + pin.name,
                                     .rule = rule.str(),
                                     .remedy = "Give a point on the plane, to a pixel"});
    }
}

} // namespace

void check_pins(const std::vector<ExemplarPin>& pins, const std::vector<Cell>& cells,
                const std::vector<Exemplar>& exemplars, const std::vector<Chart>& charts) {
  for (const ExemplarPin& pin : pins) {
    check_planes(pin, exemplars, charts);
    std::array<bool, 2> is_inside = {false, false};
    bool joined = false;
    for (const Cell& cell : cells)
      for (const Face& from : cell.faces)
        for (const Face& to : cell.faces)
          if (pin.exemplars[0] == exemplars[from.exemplar].name && pin.exemplars[1] == exemplars[to.exemplar].name) {
            const bool a = is_in(from, charts[from.exemplar], pin.points[0]);
            const bool b = is_in(to, charts[to.exemplar], pin.points[1]);
            is_inside = {is_inside[0] || a, is_inside[1] || b};
            joined = joined || (a && b);
          }
    if (!joined)
      throw ParameterError(
        Complaint{.path = is_inside[0] ? "To [m]" : "From [m]",
                  .value = "pin " + pin.name,
                  .rule = is_inside[0] && is_inside[1] ? "the two points bound no common cell"
                                                       : "the pinned point lies outside of its exemplar's section",
                  .remedy = "Move it inside, on the exemplar's plane, where both exemplars bound the same cell"});
  }
}

std::vector<WarpTable> make_warps(const Cell& cell, const std::vector<Exemplar>& exemplars,
                                  const std::vector<Chart>& charts, const WarpOptions& options,
                                  const std::vector<BothWays>& known, std::vector<BothWays>& used) {
  const int n = static_cast<int>(cell.faces.size());
  std::vector<WarpTable> tables;
  for (const Face& face : cell.faces)
    tables.push_back(empty_table(face, n));
  std::size_t number = 0;
  for (int i = 0; i < n; ++i)
    for (int j = i + 1; j < n; ++j) {
      const Face &from = cell.faces[i], &to = cell.faces[j];
      const Chart &a = charts[from.exemplar], &b = charts[to.exemplar];
      if (!are_partners(from, to, exemplars, charts, options))
        continue;
      const AlignedPair pair = align(from, a, to, b, options.pixels);
      warp::MatchOptions of_pair = options.match;
      of_pair.pins = pins_between(from, to, exemplars, charts, pair, options.pins);
      used.push_back(number < known.size() ? known[number++] : match_faces(from, a, to, b, pair, of_pair));
      const warp::Affine place_a = raster_to_chart(pair.from, pair, a), place_b = raster_to_chart(pair.to, pair, b);
      fill(tables[i], j, used.back().there, place_a, place_b);
      fill(tables[j], i, used.back().back, place_b, place_a);
    }
  return tables;
}

} // namespace kerf::texture
