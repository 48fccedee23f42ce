#include "texture/source.h"

#include "base/error.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace kerf::texture {

namespace {

Vec2 middle_of(const Face& face, const Chart& chart) {
  Vec2 sum = Vec2::Zero();
  double n = 0;
  for (int r = 0; r < face.pixels.height; ++r)
    for (int c = 0; c < face.pixels.width; ++c)
      if (face.pixels(c, r) > 0.5f) {
        sum += Vec2(c, r);
        ++n;
      }
  return chart.plane.to_local(sum / std::max(n, 1.0));
}

ParameterError refused(const Exemplar& exemplar, const std::string& key, const std::string& rule,
                       const std::string& remedy) {
  return ParameterError(Complaint{.path = key, .value = "exemplar " + exemplar.name, .rule = rule, .remedy = remedy});
}

/// Where the swept plane sees nothing in a direction, as past the end of the cell, its border stays where the row
/// before had it. No radius is zero: what would be divided by it lies outside of the body.
void complete(std::vector<double>& radii, const std::vector<double>& before, const double least) {
  for (std::size_t k = 0; k < radii.size(); ++k)
    radii[k] = std::max(radii[k] > 0 || before.empty() ? radii[k] : before[k], least);
}

/// Radii of a border that no ray meets at less than 27 degrees: where it does, and where it jumps from an arm to a bay,
/// a spiral takes the place of the bay, r ~ exp(-2 angle). So the ratio of two radii changes with the angle by at most
/// its fourfold, and what is next to each other is drawn apart by at most sqrt(1 + 4^2) times that ratio, also where
/// arms of two sections do not lie in the same directions. Other borders stay: an ellipse up to 4.2 times as long as
/// wide.
std::vector<double> without_jumps(std::vector<double> radii) {
  constexpr double slope = 2;
  const int n = static_cast<int>(radii.size());
  const auto spread = [&](const int from, const int to) {
    const double cosine = direction(from, n).dot(direction(to, n));
    radii[to] = std::max(radii[to], radii[from] * std::exp(-slope * std::acos(std::min(1.0, cosine))));
  };
  for (int k = 0; k < 2 * n; ++k) // twice around: it has no beginning
    spread(k % n, (k + 1) % n);
  for (int k = 2 * n; k > 0; --k)
    spread(k % n, (k - 1) % n);
  return radii;
}

} // namespace

Source::Source(const Face& face, const Cell& cell, const Exemplar& exemplar, const Chart& chart,
               const geometry::TriangleMesh& body)
  : exemplar_(face.exemplar), plane_(frame_of(chart.plane)), normal_(chart.plane.normal()), side_(face.side) {
  middles_.assign(n_steps, middle_of(face, chart));
  turns_ = exemplar.sweep.path == Sweep::Path::arc || exemplar.sweep.path == Sweep::Path::axis;
  if (turns_) {
    prepare_turning(face, exemplar);
    require_one_side(face, exemplar, chart);
  }
  if (std::count_if(cell.faces.begin(), cell.faces.end(),
                    [&](const Face& other) { return other.exemplar == face.exemplar; }) > 1)
    prepare_component(face, chart);
  tabulate(cell, exemplar, body, farthest(cell, body, face, chart));
}

/// Where the pixels of a component end, and how far beside them others lie.
void Source::prepare_component(const Face& face, const Chart& chart) {
  constexpr int near = 4;
  const image::Grey& pixels = face.pixels;
  to_pixels_ = chart.plane.pixels_by_local();
  beside_ = image::Grey(pixels.width, pixels.height, 1);
  for (int r = 0; r < pixels.height; ++r)
    for (int c = 0; c < pixels.width; ++c) {
      if (pixels(c, r) < 0.5f)
        continue;
      for (int dr = -near; dr <= near; ++dr)
        for (int dc = -near; dc <= near; ++dc)
          if (c + dc >= 0 && r + dr >= 0 && c + dc < pixels.width && r + dr < pixels.height) {
            const double gap = std::max(0.0, (std::hypot(dc, dr) - 1.5) / (near - 1.5)); // the next pixel is not beside
            beside_(c + dc, r + dr) = std::min(beside_(c + dc, r + dr), static_cast<float>(gap));
          }
    }
  const Vec2 middle = chart.plane.to_pixels(middles_[0]);
  for (int k = 0; k < n_directions; ++k) {
    const Vec2 along = chart.plane.to_pixels(direction(k, n_directions)).normalized();
    reach_.push_back(chart.plane.to_local(reach(pixels, middle, along) * along).norm());
  }
}

double Source::drawn_in(const double length, const double radius, const Vec2& along) const {
  if (length <= radius)
    return length;
  const Vec2 pixel = to_pixels_ * (middles_[0] + length * along);
  return length -
         (length - radius) * image::sample(beside_, static_cast<float>(pixel[0]), static_cast<float>(pixel[1]));
}

/// The plane turns about the line centre_ + s axis_, which lies in it; outward_ points from the line to the barycentre.
void Source::prepare_turning(const Face& face, const Exemplar& exemplar) {
  const Vec3 barycentre = plane_.origin + middles_[0][0] * plane_.x + middles_[0][1] * plane_.y;
  const Sweep& sweep = exemplar.sweep;
  inward_ = side_ * normal_;
  centre_ = sweep.point - normal_.dot(sweep.point - plane_.origin) * normal_;
  const double size = (barycentre - plane_.origin).norm() + std::sqrt(static_cast<double>(face.area));
  const Vec3 away = barycentre - centre_;
  if (sweep.path == Sweep::Path::arc) {
    if (!(away.norm() > 1e-6 * size))
      throw refused(exemplar, "Centre [m]", "the barycentre of a face lies at the centre of its great arc",
                    "Divide the section by another exemplar through the centre first, or sweep along the normal");
    outward_ = away.normalized();
    axis_ = outward_.cross(normal_);
    return;
  }
  const Vec3 in_plane = sweep.axis - normal_.dot(sweep.axis) * normal_;
  if (!(in_plane.norm() > 0.9 * sweep.axis.norm()) || !(sweep.axis.norm() > 0))
    throw refused(exemplar, "Axis [1]", "the axis of the sweep must lie in the plane",
                  "Give an axis at a right angle to the plane's normal");
  axis_ = in_plane.normalized();
  outward_ = away - axis_.dot(away) * axis_;
  if (!(outward_.norm() > 1e-6 * size))
    throw refused(exemplar, "Axis [1]", "the axis passes through the barycentre of a face: it has no side to turn to",
                  "Divide the section by another exemplar through the axis first, or sweep along the normal");
  outward_.normalize();
}

/// A plane that turns reaches a point from one side only: what lies beyond the axis would be taken for its mirror
/// image.
void Source::require_one_side(const Face& face, const Exemplar& exemplar, const Chart& chart) const {
  double least = 0;
  for (int r = 0; r < face.pixels.height; ++r)
    for (int c = 0; c < face.pixels.width; ++c)
      if (face.pixels(c, r) > 0.5f)
        least = std::min(least, outward_.dot(chart.plane.point(chart.plane.to_local(Vec2(c, r))) - centre_));
  if (least < -2 * chart.plane.pixel())
    throw refused(exemplar, exemplar.sweep.path == Sweep::Path::arc ? "Centre [m]" : "Axis [1]",
                  "the plane turns about a line that crosses a face: what lies beyond it cannot be reached",
                  "Divide the section by another exemplar through that line first, or sweep along the normal");
}

Source::Swept Source::turn(const Vec3& p) const {
  const Vec3 d = p - centre_;
  const double along = axis_.dot(d), out = outward_.dot(d), in = inward_.dot(d);
  const Vec3 back = centre_ + along * axis_ + std::hypot(out, in) * outward_ - plane_.origin;
  return {std::max(0.0, std::atan2(in, out)), Vec2(plane_.x.dot(back), plane_.y.dot(back))};
}

/// The plane where it has gone by t, with the coordinates that turn() and sweep() give.
Frame Source::frame(const double t) const {
  if (!turns_)
    return {plane_.origin + t * side_ * normal_, plane_.x, plane_.y};
  const double sense = axis_.cross(outward_).dot(inward_) > 0 ? 1 : -1;
  const Mat3 turned = Eigen::AngleAxisd(sense * t, axis_).toRotationMatrix();
  return {centre_ + turned * (plane_.origin - centre_), turned * plane_.x, turned * plane_.y};
}

/// How far the plane goes until it has passed the cell: over its part of the skin and its other faces.
double Source::farthest(const Cell& cell, const geometry::TriangleMesh& body, const Face& face,
                        const Chart& chart) const {
  double t = 4 * chart.plane.pixel();
  if (turns_)
    t /= std::sqrt(static_cast<double>(face.area)) * chart.plane.pixel();
  const auto is_in = [&](const Vec3& p) {
    return std::all_of(cell.halves.begin(), cell.halves.end(), [&](const HalfSpace& half) { return half.contains(p); });
  };
  Box box;
  box.lower = Vec3::Constant(1e300);
  box.upper = Vec3::Constant(-1e300);
  for (const Vec3& v : body.vertices) {
    box.lower = box.lower.cwiseMin(v);
    box.upper = box.upper.cwiseMax(v);
    if (is_in(v))
      t = std::max(t, sweep(v).t);
  }
  if (turns_)
    return std::min(std::max(t, 0.1), M_PI);
  // Other faces: the plane cannot go beyond where the cell's half spaces leave the body's box. Rays of the box are
  // enough.
  const double reach = (box.upper - box.lower).norm();
  double bound = t;
  for (const HalfSpace& half : cell.halves)
    if (const double rate = half.normal.dot(side_ * normal_); rate > 0.2) {
      const Vec3 barycentre = plane_.origin + middles_[0][0] * plane_.x + middles_[0][1] * plane_.y;
      bound = std::max(bound, std::min(reach, (half.offset - half.normal.dot(barycentre)) / rate));
    }
  return bound;
}

void Source::tabulate(const Cell& cell, const Exemplar& exemplar, const geometry::TriangleMesh& body,
                      const double t_max) {
  steps_by_t_ = (n_steps - 1) / t_max;
  std::vector<HalfSpace> halves = cell.halves;
  for (HalfSpace& half : halves)
    if (std::abs(half.normal.dot(normal_)) > 1 - 1e-12 &&
        std::abs(half.normal.dot(plane_.origin) - half.offset) < 1e-12)
      half = HalfSpace{}; // its own plane bounds no ray in it
  Vec2 middle = middles_[0];
  double least = 0;
  std::vector<double> guess = reach_, before;
  for (int i = 0; i < n_steps; ++i) {
    const Frame at = frame(i / steps_by_t_);
    const auto curves = slice(body, at);
    std::vector<double> row = radii(curves, at, halves, middle, n_directions, guess);
    if (i > 0 && exemplar.sweep.path == Sweep::Path::middles)
      for (int round = 0; round < 2; ++round) {
        middle = star_middle(middle, row);
        row = radii(curves, at, halves, middle, n_directions, guess);
      }
    if (i == 0)
      least = 1e-3 * *std::max_element(row.begin(), row.end()) + 1e-300;
    complete(row, before, least);
    before = row;
    if (!guess.empty())
      guess = row;
    middles_[i] = middle;
    const auto add_squares = [](const std::vector<double>& radii, std::vector<float>& squares) {
      for (int k = 0; k <= n_directions; ++k)
        squares.push_back(static_cast<float>(radii[k % n_directions] * radii[k % n_directions]));
    };
    if (i == 0 && !reach_.empty())
      add_squares(row, squared_border_);
    add_squares(without_jumps(row), squared_radii_);
  }
}

Vec2 Source::find(const Swept& swept) const {
  const double step = std::clamp(swept.t * steps_by_t_, 0.0, n_steps - 1 - 1e-9);
  const int i = static_cast<int>(step);
  const double s = step - i;
  const Vec2 arm = swept.local - ((1 - s) * middles_[i] + s * middles_[i + 1]);
  const double number = direction_number(arm[0], arm[1], n_directions);
  const int k = static_cast<int>(number);
  const double u = number - k;
  constexpr int row = n_directions + 1;
  const auto squared = [&](const int step_number) {
    const float* const r = &squared_radii_[step_number * row + k];
    return (1 - u) * r[0] + u * r[1];
  };
  const double here = squared(0), there = (1 - s) * squared(i) + s * squared(i + 1);
  const double ratio = std::sqrt(here / there);
  if (!reach_.empty()) {
    const double length = arm.norm(), border = std::sqrt((1 - u) * squared_border_[k] + u * squared_border_[k + 1]);
    return length > 0 ? Vec2(middles_[0] + drawn_in(length * ratio, border, arm / length) * arm / length) : middles_[0];
  }
  // Far beyond the boundary, outside of the body, the source point stays there. How far is far falls from infinity in
  // the face itself, where interpolated radii may cut a corner off and the source point must still be the point itself:
  // there (step + far) / step.
  const double squared_length = arm.squaredNorm() * step * step, farthest = there * (step + far) * (step + far);
  return middles_[0] + (squared_length > farthest ? ratio * std::sqrt(farthest / squared_length) : ratio) * arm;
}

void Source::find(const Lanes* const points, Lanes& x, Lanes& y, Lanes& distances) const {
  if (!turns_ && reach_.empty()) {
    const auto numbers = [](const Vec3& v) { return std::array<double, 3>{v[0], v[1], v[2]}; };
    find_source_points({numbers(plane_.origin), numbers(plane_.x), numbers(plane_.y), numbers(side_ * normal_),
                        steps_by_t_, n_steps, n_directions, far, squared_radii_.data(), middles_.front().data()},
                       points, x, y, distances);
    return;
  }
  for (int l = 0; l < n_lanes; ++l) {
    const Point point = find(Vec3(points[0][l], points[1][l], points[2][l]));
    x[l] = point.local[0];
    y[l] = point.local[1];
    distances[l] = point.distance;
  }
}

} // namespace kerf::texture
