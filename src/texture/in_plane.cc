#include "texture/in_plane.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>

namespace kerf::texture {

namespace {

/// Keeps its memory.
template <class Value>
void reset(image::Raster<Value>& raster, const int width, const int height) {
  raster.width = width;
  raster.height = height;
  raster.values.assign(static_cast<std::size_t>(width) * height, Value());
}

} // namespace

void InPlane::lay(const std::span<const Corners> triangles) {
  const bool has_relief = relief_ == Relief::wanted;
  change_.width = height_.width = 0;
  others_.clear();
  const auto& [a, b, c] = triangles.front();
  const Vec3 area = (b - a).cross(c - a);
  if ((!detail_ && !has_relief) || !(area.norm() > 0))
    return;
  const Vec3 normal = area.normalized();
  x_ = in_plane(inside_.charts().front().body_axes, normal);
  y_ = normal.cross(x_);
  const double margin = has_relief ? 2 : 1;
  lay_out(triangles, margin);
  mark(margin, detail_ ? window_radius : 0);
  windows_.reset(width_, height_in_points_);
  find_blends();
  for (int r = 0; r < height_in_points_; ++r)
    find_luminance(r);
  if (detail_)
    reset(change_, width_, height_in_points_);
  if (has_relief)
    reset(height_, width_, height_in_points_);
  for (int r = 0; r < height_in_points_; ++r) {
    if (detail_)
      find_change(r);
    if (has_relief)
      find_height(r);
  }
}

float InPlane::rise(const Eigen::Vector2f& q, const Eigen::Vector2f& d) const {
  if (height_.width == 0)
    return 0;
  return image::sample(height_, q[0] + d[0], q[1] + d[1]) - image::sample(height_, q[0] - d[0], q[1] - d[1]);
}

/// The part of the plane's lattice around triangles, and where they lie in it: what is within `margin` points of them
/// is asked for, and windows reach beyond that. Starts at a point that has a blend of its own.
void InPlane::lay_out(const std::span<const Corners> triangles, const double margin) {
  pixel_ = inside_.pixel();
  flat_.resize(triangles.size());
  Vec2 lower = Vec2::Constant(1e300), upper = -lower;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (int i = 0; i < 3; ++i) {
      const Vec3 d = triangles[t][i] - inside_.origin();
      flat_[t][i] = Vec2(x_.dot(d), y_.dot(d)) / pixel_;
      lower = lower.cwiseMin(flat_[t][i]);
      upper = upper.cwiseMax(flat_[t][i]);
    }
  const double around = margin + window_radius + 1;
  const Vec2 first = step * ((lower.array() - around) / step).floor().matrix();
  const Vec2 size = step * ((upper - first).array() / step + around / step).ceil().matrix();
  const Vec3 normal = x_.cross(y_);
  const double height = normal.dot(triangles.front()[0] - inside_.origin());
  origin_ = inside_.origin() + height * normal + pixel_ * (first[0] * x_ + first[1] * y_);
  width_ = static_cast<int>(size[0]) + 1;
  height_in_points_ = static_cast<int>(size[1]) + 1;
  for (Flat& triangle : flat_)
    for (Vec2& corner : triangle)
      corner -= first;
}

/// The columns of a row that are within a margin of a triangle.
Span InPlane::span_of(const Flat& triangle, const int row, const double margin) const {
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

/// Marks the points that are within a margin of triangles, and those that windows of that radius around them reach.
void InPlane::mark(const double margin, const int radius) {
  reset(asked_, width_ / step + 1, height_in_points_);
  for (const Flat& triangle : flat_) {
    const auto [low, high] = std::minmax({triangle[0][1], triangle[1][1], triangle[2][1]});
    const int last_row = static_cast<int>(std::floor(high + margin));
    for (int r = static_cast<int>(std::ceil(low - margin)); r <= last_row; ++r) {
      const Span span = span_of(triangle, r, margin);
      for (int k = span.first / step; k <= span.last / step && span.first <= span.last; ++k) {
        const int first = std::max(span.first - k * step, 0), last = std::min(span.last - k * step, step - 1);
        asked_(k, r) |= static_cast<Lanes>((2 << last) - (1 << first));
      }
    }
  }
  // Rows around each row in one, then columns.
  const int n = asked_.width * asked_.height, beyond = radius * asked_.width;
  rows_.assign(static_cast<std::size_t>(n + 2 * beyond), 0);
  for (int k = 0; k <= 2 * radius; ++k) {
    Lanes* const rows = &rows_[k * asked_.width];
    for (int i = 0; i < n; ++i)
      rows[i] |= asked_.values[i];
  }
  reset(reached_, asked_.width, asked_.height);
  for (int r = 0; r < reached_.height; ++r) {
    const Lanes* const rows = &rows_[beyond + r * reached_.width];
    unsigned before = 0, here = rows[0];
    for (int k = 0; k < reached_.width; ++k) {
      const unsigned next = k + 1 < reached_.width ? rows[k + 1] : 0;
      const unsigned row = before | here << step | next << 2 * step;
      unsigned reached = row;
      for (int shift = 1; shift <= radius; ++shift)
        reached |= row << shift | row >> shift;
      reached_(k, r) = static_cast<Lanes>(reached >> step);
      before = here;
      here = next;
    }
  }
}

void InPlane::find_blends() {
  blends_.width = width_ / step + 1;
  blends_.height = height_in_points_ / step + 1;
  blends_.values.resize(static_cast<std::size_t>(blends_.width) * blends_.height);
  reset(needed_, blends_.width, blends_.height);
  for (int r = 0; r < height_in_points_; ++r)
    for (int i = 0; i + 1 < blends_.width; ++i)
      if (reached_(i, r) != 0)
        needed_(i, r / step) = 1;
  const auto is_needed = [&](const int i, const int k) { return i >= 0 && k >= 0 && needed_(i, k) != 0; };
  std::array<Vec3, n_lanes> points;
  std::array<Blend*, n_lanes> places;
  std::size_t n = 0;
  const auto find = [&] {
    inside_.blend(std::span(points).first(n), inside_.options().blending, places);
    n = 0;
  };
  for (int k = 0; k < blends_.height; ++k)
    for (int i = 0; i < blends_.width; ++i)
      if (is_needed(i, k) || is_needed(i - 1, k) || is_needed(i, k - 1) || is_needed(i - 1, k - 1)) {
        points[n] = point(i * step, k * step);
        places[n++] = &blends_(i, k);
        if (n == n_lanes)
          find();
      }
  if (n > 0)
    find();
}

template <class Block, class Point>
void InPlane::for_each_block(const int row, const Marks& marks, const Block& block, const Point& point) {
  const int k = row / step;
  for (int i = 0; i + 1 < blends_.width; ++i) {
    if (marks(i, row) == 0)
      continue;
    const Around around = nearest(i, k);
    if (std::all_of(around.begin(), around.end(), [&](const Blend* b) { return b->cell == around[0]->cell; }))
      block(i * step, around); // cells are convex: the points lie in the same one
    else
      for (int lane = 0; lane < step; ++lane)
        if ((marks(i, row) >> lane & 1) != 0)
          point(i * step + lane, mixed(i * step + lane, row));
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
  const auto [place, is_new] = others_.try_emplace({i, k, cell});
  if (is_new)
    place->second = inside_.blend(point(i * step, k * step), inside_.options().blending, cell);
  return &place->second;
}

void InPlane::find_luminance(const int row) {
  float* const out = &windows_.luminance(0, row);
  const auto grey = [&](const Blend& blend, const int i) -> const image::Grey& {
    return inside_.charts()[blend.exemplars[i]].luminance;
  };
  for_each_block(
    row, reached_,
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

void InPlane::find_change(const int row) {
  float* const out = &change_(0, row);
  for (int i = 0; i + 1 < blends_.width; ++i)
    if (asked_(i, row) != 0)
      windows_.find(row, {i * step, i * step + step - 1});
  for_each_block(
    row, asked_,
    [&](const int first, const Around& around) {
      std::array<float, n_lanes> sums = {};
      for (int i = 0; i < around[0]->n; ++i)
        detail_->histograms(around[0]->exemplars[i])
          .add(points(around, i, row), &windows_.place(first, row), sums.data());
      for (int lane = 0; lane < step; ++lane)
        out[first + lane] = sums[lane] - (windows_.luminance(first + lane, row) - windows_.mean(first + lane, row));
    },
    [&](const int column, const Blend& blend) {
      out[column] = detail_->luminance(blend, windows_.place(column, row)) -
                    (windows_.luminance(column, row) - windows_.mean(column, row));
    });
}

void InPlane::find_height(const int row) {
  const bool changes = change_.width > 0;
  for (int i = 0; i + 1 < blends_.width; ++i)
    if (asked_(i, row) != 0)
      for (int c = i * step; c < i * step + step; ++c)
        height_(c, row) = std::clamp(windows_.luminance(c, row) + (changes ? change_(c, row) : 0), 0.0f, 1.0f);
}

} // namespace kerf::texture
