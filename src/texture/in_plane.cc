#include "texture/in_plane.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace kerf::texture {

namespace {

/// Bilinear between four corners.
struct Quad {
  std::array<float, 4> shares;
  Quad(const float right, const float down)
    : shares{(1 - right) * (1 - down), right * (1 - down), (1 - right) * down, right * down} {}
  template <class Value>
  float operator()(const std::array<const Blend*, 4>& blends, const Value& value) const {
    return shares[0] * value(*blends[0]) + shares[1] * value(*blends[1]) + shares[2] * value(*blends[2]) +
           shares[3] * value(*blends[3]);
  }
};

} // namespace

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
    if (detail)
      windows.find(r, spans_[r]);
    for (int c = spans_[r].first; c <= spans_[r].last; ++c) {
      const float luminance = windows.luminance(c, r);
      if (detail)
        change_(c, r) = detail_at(c, r, *detail, windows.place(c, r)) - (luminance - windows.mean(c, r));
      if (has_relief)
        height_(c, r) = std::clamp(luminance + (detail ? change_(c, r) : 0), 0.0f, 1.0f);
    }
  }
}

Eigen::Array4f InPlane::colour(const Vec3& p) const {
  const Eigen::Array4f colour = inside_.colour(p);
  return change_.width > 0 ? (colour + sample(change_, p)).max(0.0f).min(1.0f).eval() : colour;
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

/// Along a row, as long as the blends around stay the same.
void InPlane::find_luminance(const int row, const Span& span, Windows& windows) {
  for (int c = span.first; c <= span.last;) {
    const Around first = around(c, row);
    const bool is_whole = first[0] == &blends_(c / step, row / step) &&
                          first[3] == &blends_(c / step + 1, row / step + 1) && first[1] == first[0] + 1 &&
                          first[2] == first[3] - 1;
    const int last =
      is_whole ? std::min(span.last, c - c % step + step - 1) : c; // else the next may be in another cell
    add_luminance(row, {c, last}, first, windows);
    c = last + 1;
  }
}

void InPlane::add_luminance(const int row, const Span& span, const Around& around, Windows& windows) const {
  const float down = static_cast<float>(row % step) / step;
  const auto along = [down](const float upper, const float lower) { return upper + down * (lower - upper); };
  float* const out = &windows.luminance(0, row);
  for (int i = 0; i < around[0]->n; ++i) {
    const image::Grey& grey = inside_.charts()[around[0]->exemplars[i]].luminance;
    const auto& [a, b, c, d] = around;
    const Eigen::Array4f left(along(a->weights[i], c->weights[i]), along(a->x[i], c->x[i]), along(a->y[i], c->y[i]), 0);
    const Eigen::Array4f right(along(b->weights[i], d->weights[i]), along(b->x[i], d->x[i]), along(b->y[i], d->y[i]),
                               0);
    for (int k = span.first; k <= span.last; ++k) {
      const Eigen::Array4f at = left + static_cast<float>(k % step) / step * (right - left);
      out[k] += at[0] * image::sample(grey, at[1], at[2]);
    }
  }
  for (int k = span.first; k <= span.last; ++k)
    out[k] = std::clamp(out[k], 0.0f, 1.0f);
}

InPlane::Around InPlane::around(const int column, const int row) {
  const int i = std::min(column / step, blends_.width - 2), k = std::min(row / step, blends_.height - 2);
  const Around nearest = {&blends_(i, k), &blends_(i + 1, k), &blends_(i, k + 1), &blends_(i + 1, k + 1)};
  const int cell = nearest[0]->cell;
  if (std::all_of(nearest.begin(), nearest.end(), [&](const Blend* b) { return b->cell == cell; }))
    return nearest; // cells are convex: the point lies in the same one
  const int own = inside_.partition().find(point(column, row));
  return {corner(i, k, own), corner(i + 1, k, own), corner(i, k + 1, own), corner(i + 1, k + 1, own)};
}

const Blend* InPlane::corner(const int column, const int row, const int cell) {
  if (blends_(column, row).cell == cell)
    return &blends_(column, row);
  for (const Other& other : others_)
    if (other.column == column && other.row == row && other.blend.cell == cell)
      return &other.blend;
  const Vec3 p = point(column * step, row * step);
  others_.push_back({column, row, inside_.blend(p, inside_.options().blending, cell)});
  return &others_.back().blend;
}

float InPlane::detail_at(const int column, const int row, const Detail& detail, const float place) {
  const Around around = this->around(column, row);
  const Quad quad(static_cast<float>(column % step) / step, static_cast<float>(row % step) / step);
  Blend blend;
  blend.n = around[0]->n;
  blend.exemplars = around[0]->exemplars;
  for (int i = 0; i < blend.n; ++i) {
    blend.weights[i] = quad(around, [&](const Blend& b) { return b.weights[i]; });
    blend.x[i] = quad(around, [&](const Blend& b) { return b.x[i]; });
    blend.y[i] = quad(around, [&](const Blend& b) { return b.y[i]; });
  }
  return detail.luminance(blend, place);
}

} // namespace kerf::texture
