#include "texture/in_plane.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace kerf::texture {

InPlane::InPlane(const Interior& inside, const Detail* const detail, const Relief relief, const Corners& corners)
  : inside_(inside) {
  const bool has_relief = relief == Relief::wanted;
  const Vec3 area = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
  if ((!detail && !has_relief) || !(area.norm() > 0))
    return;
  const Vec3 normal = area.normalized();
  x_ = in_plane(inside.charts().front().body_axes, normal);
  y_ = normal.cross(x_);
  lay_out(corners, has_relief ? 2 : 1);
  std::vector<Span> rows;
  for (int r = 0; r < height_in_points_; ++r)
    rows.push_back(reached(r, detail ? window_radius : 0));
  Windows windows(width_, height_in_points_, 0, 1);
  find_blends(rows);
  for (int r = 0; r < height_in_points_; ++r)
    find_luminance(r, rows[r], windows);
  if (detail)
    change_ = image::Grey(width_, height_in_points_, 0);
  if (has_relief)
    height_ = image::Grey(width_, height_in_points_, 0);
  for (int r = 0; r < height_in_points_; ++r) {
    if (detail) {
      windows.find(r, spans_[r]);
      find_change(r, *detail, windows);
    }
    if (has_relief)
      find_height(r, windows);
  }
}

Eigen::Array4f InPlane::colour(const Vec3& p) const {
  const Eigen::Array4f colour = inside_.colour(p);
  if (change_.width == 0)
    return colour;
  const Eigen::Vector2f q = on_lattice(p).cast<float>();
  return (colour + image::sample(change_, q[0], q[1])).max(0.0f).min(1.0f);
}

float InPlane::rise(const Vec3& p, const Vec3& along) const {
  if (height_.width == 0)
    return 0;
  const Eigen::Vector2f q = on_lattice(p).cast<float>(), d = Vec2(x_.dot(along), y_.dot(along)).cast<float>();
  return image::sample(height_, q[0] + d[0], q[1] + d[1]) - image::sample(height_, q[0] - d[0], q[1] - d[1]);
}

/// The part of the plane's lattice around a triangle: what lies within `margin` points of it is asked for, for
/// interpolation and slopes, and windows reach beyond that. Starts at a point that has a blend of its own.
void InPlane::lay_out(const Corners& corners, const double margin) {
  pixel_ = inside_.pixel();
  std::array<Vec2, 3> flat;
  Vec2 lower = Vec2::Constant(1e300), upper = -lower;
  for (int i = 0; i < 3; ++i) {
    const Vec3 d = corners[i] - inside_.origin();
    flat[i] = Vec2(x_.dot(d), y_.dot(d)) / pixel_;
    lower = lower.cwiseMin(flat[i]);
    upper = upper.cwiseMax(flat[i]);
  }
  const double around = margin + window_radius + 1;
  const Vec2 first = step * ((lower.array() - around) / step).floor().matrix();
  const Vec2 size = step * ((upper - first).array() / step + around / step).ceil().matrix();
  const Vec3 normal = x_.cross(y_);
  const double height = normal.dot(corners[0] - inside_.origin());
  origin_ = inside_.origin() + height * normal + pixel_ * (first[0] * x_ + first[1] * y_);
  width_ = static_cast<int>(size[0]) + 1;
  height_in_points_ = static_cast<int>(size[1]) + 1;
  for (Vec2& corner : flat)
    corner -= first;
  for (int r = 0; r < height_in_points_; ++r)
    spans_.push_back(span_of(flat, r, margin));
}

/// The columns of a row that are within a margin of a triangle.
Span InPlane::span_of(const std::array<Vec2, 3>& triangle, const int row, const double margin) const {
  const double below = row - margin, above = row + margin;
  double left = 1e300, right = -1e300;
  for (int i = 0; i < 3; ++i) {
    const Vec2 &a = triangle[i], &b = triangle[(i + 1) % 3];
    if (std::max(a[1], b[1]) < below || std::min(a[1], b[1]) > above)
      continue;
    // The part of the side between the two heights.
    const double rise = b[1] - a[1];
    const double s = rise != 0 ? std::clamp((below - a[1]) / rise, 0.0, 1.0) : 0;
    const double t = rise != 0 ? std::clamp((above - a[1]) / rise, 0.0, 1.0) : 1;
    for (const double u : {s, t}) {
      left = std::min(left, a[0] + u * (b[0] - a[0]));
      right = std::max(right, a[0] + u * (b[0] - a[0]));
    }
  }
  if (left > right)
    return {};
  return {static_cast<int>(std::ceil(left - margin)), static_cast<int>(std::floor(right + margin))};
}

/// The columns of a row that what is asked for in the rows around it reaches.
Span InPlane::reached(const int row, const int radius) const {
  Span span{1 << 20, -(1 << 20)};
  for (int r = std::max(0, row - radius); r <= std::min(height_in_points_ - 1, row + radius); ++r)
    if (spans_[r].last >= spans_[r].first) {
      span.first = std::min(span.first, spans_[r].first - radius);
      span.last = std::max(span.last, spans_[r].last + radius);
    }
  return span;
}

void InPlane::find_blends(const std::vector<Span>& rows) {
  blends_ = image::Raster<Blend>(width_ / step + 1, height_in_points_ / step + 1, Blend());
  std::vector<Span> needed(blends_.height, Span{1 << 20, -1});
  for (int r = 0; r < height_in_points_; ++r)
    if (rows[r].last >= rows[r].first)
      for (const int k : {r / step, std::min(r / step + 1, blends_.height - 1)}) {
        needed[k].first = std::min(needed[k].first, rows[r].first / step);
        needed[k].last = std::max(needed[k].last, rows[r].last / step + 1);
      }
  for (int k = 0; k < blends_.height; ++k)
    for (int i = needed[k].first; i <= std::min(needed[k].last, blends_.width - 1); ++i)
      blends_(i, k) = inside_.blend(point(i * step, k * step), inside_.options().blending);
}

template <class Block, class Point>
void InPlane::for_each_block(const int row, const Span& span, const Block& block, const Point& point) {
  const int k = row / step;
  for (int i = span.first / step; i <= span.last / step && span.first <= span.last; ++i) {
    const Around around = nearest(i, k);
    if (std::all_of(around.begin(), around.end(), [&](const Blend* b) { return b->cell == around[0]->cell; }))
      block(i * step, around); // cells are convex: the points lie in the same one
    else
      for (int c = std::max(span.first, i * step); c <= std::min(span.last, i * step + step - 1); ++c)
        point(c, mixed(c, row));
  }
}

/// Of eight points from a blend to the next one, what exemplar i shows.
PointRow InPlane::points(const Around& around, const int i, const int row) const {
  const float down = static_cast<float>(row % step) / step;
  const auto& [a, b, c, d] = around;
  const auto between = [down](const float upper, const float lower) { return upper + down * (lower - upper); };
  const Eigen::Array3f left(between(a->weights[i], c->weights[i]), between(a->x[i], c->x[i]),
                            between(a->y[i], c->y[i]));
  const Eigen::Array3f right(between(b->weights[i], d->weights[i]), between(b->x[i], d->x[i]),
                             between(b->y[i], d->y[i]));
  const Eigen::Array3f each = (right - left) / step;
  return {left[0], left[1], left[2], each[0], each[1], each[2]};
}

/// The blend of a point between blends of several cells.
Blend InPlane::mixed(const int column, const int row) {
  const int i = column / step, k = row / step, own = inside_.partition().find(point(column, row));
  const Around around = {corner(i, k, own), corner(i + 1, k, own), corner(i, k + 1, own), corner(i + 1, k + 1, own)};
  const auto right = static_cast<float>(column % step);
  Blend blend;
  blend.n = around[0]->n;
  blend.cell = own;
  blend.exemplars = around[0]->exemplars;
  for (int e = 0; e < blend.n; ++e) {
    const PointRow p = points(around, e, row);
    blend.weights[e] = p.weight + right * p.weight_step;
    blend.x[e] = p.x + right * p.x_step;
    blend.y[e] = p.y + right * p.y_step;
  }
  return blend;
}

const Blend* InPlane::corner(const int i, const int k, const int cell) {
  if (blends_(i, k).cell == cell)
    return &blends_(i, k);
  for (const Other& other : others_)
    if (other.column == i && other.row == k && other.blend.cell == cell)
      return &other.blend;
  others_.push_back({i, k, inside_.blend(point(i * step, k * step), inside_.options().blending, cell)});
  return &others_.back().blend;
}

void InPlane::find_luminance(const int row, const Span& span, Windows& windows) {
  float* const out = &windows.luminance(0, row);
  const auto grey = [&](const Blend& blend, const int i) -> const image::Grey& {
    return inside_.charts()[blend.exemplars[i]].luminance;
  };
  for_each_block(
    row, span,
    [&](const int first, const Around& around) {
      std::array<float, n_lanes> sums = {};
      for (int i = 0; i < around[0]->n; ++i) {
        const image::Grey& g = grey(*around[0], i);
        add_values(g.values.data(), g.width, g.height, points(around, i, row), sums.data());
      }
      std::copy_n(sums.begin(), step, out + first);
    },
    [&](const int column, const Blend& blend) {
      for (int i = 0; i < blend.n; ++i)
        out[column] += blend.weights[i] * image::sample(grey(blend, i), blend.x[i], blend.y[i]);
    });
}

void InPlane::find_change(const int row, const Detail& detail, const Windows& windows) {
  float* const out = &change_(0, row);
  for_each_block(
    row, spans_[row],
    [&](const int first, const Around& around) {
      std::array<float, n_lanes> sums = {};
      for (int i = 0; i < around[0]->n; ++i)
        detail.histograms(around[0]->exemplars[i]).add(points(around, i, row), &windows.place(first, row), sums.data());
      std::copy_n(sums.begin(), step, out + first);
    },
    [&](const int column, const Blend& blend) { out[column] = detail.luminance(blend, windows.place(column, row)); });
  for (int c = spans_[row].first; c <= spans_[row].last; ++c)
    out[c] -= windows.luminance(c, row) - windows.mean(c, row);
}

void InPlane::find_height(const int row, const Windows& windows) {
  for (int c = spans_[row].first; c <= spans_[row].last; ++c) {
    const float change = change_.width > 0 ? change_(c, row) : 0;
    height_(c, row) = std::clamp(windows.luminance(c, row) + change, 0.0f, 1.0f);
  }
}

} // namespace kerf::texture
