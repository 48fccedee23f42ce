#include "texture/atlas.h"

#include "base/parallel.h"
#include "image/formats.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace kerf::texture {

namespace {

using Corners = std::array<Vec3, 3>;

/// Colours of points in the plane of a triangle.
class InPlane {
 public:
  InPlane(const Corners& corners, const Paint& paint) : inside_(*paint.inside), painted_() {
    const Vec3 area = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    if (!paint.detail || !(area.norm() > 0))
      return;
    lay_out(corners, area.normalized(), paint.relief != 0 ? 2 : 1);
    painted_ = paint_spans(inside_, patch_, *paint.detail, spans_);
  }

  Eigen::Array4f operator()(const Vec3& p) const {
    if (painted_.width == 0)
      return inside_.colour(p);
    const Vec3 d = (p - patch_.origin) / (pixel_ * pixel_);
    return image::sample(painted_, static_cast<float>(patch_.column.dot(d)), static_cast<float>(patch_.row.dot(d)));
  }

 private:
  /// A lattice of points that is the same for all triangles of a plane: its axes are those of the first exemplar. What
  /// is within `margin` points of the triangle is asked for: for interpolation, and for slopes.
  void lay_out(const Corners& corners, const Vec3& normal, const double margin) {
    const SectionPlane& plane = inside_.charts().front().plane;
    Vec3 x = plane.x() - normal.dot(plane.x()) * normal;
    if (x.norm() < 0.3)
      x = plane.y() - normal.dot(plane.y()) * normal;
    x.normalize();
    const Vec3 y = normal.cross(x);
    pixel_ = inside_.pixel();
    Vec2 lower = Vec2::Constant(1e300), upper = -lower;
    std::array<Vec2, 3> flat;
    for (int i = 0; i < 3; ++i) {
      flat[i] = plane_coordinates(corners[i] - plane.origin(), x, y);
      lower = lower.cwiseMin(flat[i]);
      upper = upper.cwiseMax(flat[i]);
    }
    const Vec2 first = (lower.array().floor() - margin).matrix(), size = (upper - first).array().ceil() + margin;
    const double height = normal.dot(corners[0] - plane.origin());
    patch_ = {plane.origin() + height * normal + pixel_ * (first[0] * x + first[1] * y), pixel_ * x, pixel_ * y,
              static_cast<int>(size[0]) + 1, static_cast<int>(size[1]) + 1};
    for (int r = 0; r < patch_.height; ++r)
      spans_.push_back(span_of(flat, first, r, margin));
  }
  /// The columns of a row that are within a margin of a triangle.
  Span span_of(const std::array<Vec2, 3>& triangle, const Vec2& first, const int row, const double margin) const {
    const double below = first[1] + row - margin, above = first[1] + row + margin;
    double left = 1e300, right = -1e300;
    for (int i = 0; i < 3; ++i) {
      const Vec2 &a = triangle[i], &b = triangle[(i + 1) % 3];
      // The part of the side between the two heights.
      const double rise = b[1] - a[1];
      const double s = rise != 0 ? std::clamp((below - a[1]) / rise, 0.0, 1.0) : 0;
      const double t = rise != 0 ? std::clamp((above - a[1]) / rise, 0.0, 1.0) : 1;
      if (std::max(a[1], b[1]) < below || std::min(a[1], b[1]) > above)
        continue;
      for (const double u : {s, t}) {
        left = std::min(left, a[0] + u * (b[0] - a[0]));
        right = std::max(right, a[0] + u * (b[0] - a[0]));
      }
    }
    if (left > right)
      return {};
    return {std::max(0, static_cast<int>(std::ceil(left - margin - first[0]))),
            std::min(patch_.width - 1, static_cast<int>(std::floor(right + margin - first[0])))};
  }
  Vec2 plane_coordinates(const Vec3& d, const Vec3& x, const Vec3& y) const {
    return Vec2(x.dot(d), y.dot(d)) / pixel_;
  }

  const Interior& inside_;
  Patch patch_;
  std::vector<Span> spans_;
  double pixel_ = 1;
  image::Raster<Eigen::Array4f> painted_;
};

/// By how much the relief rises along a whole edge, seen at p.
float slope(const InPlane& colours, const Vec3& p, const Vec3& edge, const double relief, const double pixel) {
  const double length = edge.norm();
  if (!(length > 0))
    return 0;
  const Vec3 step = pixel / length * edge;
  const float rise = colours(p + step)[3] - colours(p - step)[3];
  return static_cast<float>(relief * rise * length / (2 * pixel));
}

std::array<std::uint8_t, 3> to_bytes(const Eigen::Array4f& colour) {
  return {image::to_byte(colour[0]), image::to_byte(colour[1]), image::to_byte(colour[2])};
}

Corners corners_of(const SurfaceView& surface, const std::size_t t) {
  const Triangle& v = surface.triangles[t];
  return {surface.rest[v[0]], surface.rest[v[1]], surface.rest[v[2]]};
}

double longest_side(const Corners& corners) {
  double longest = 0;
  for (int i = 0; i < 3; ++i)
    longest = std::max(longest, (corners[(i + 1) % 3] - corners[i]).norm());
  return longest;
}

int parts_for(const Corners& corners, const double resolution) {
  const double n = std::min(std::ceil(longest_side(corners) / resolution), double(Atlas::max_parts));
  return std::max(static_cast<int>(n), 1);
}

} // namespace

void Atlas::fill_triangle(const std::size_t t, const SurfaceView& surface, const Paint& paint) {
  const Corners corners = corners_of(surface, t);
  const Vec3 u = corners[1] - corners[0], v = corners[2] - corners[0];
  const int n = parts_[t];
  std::uint32_t sample = first_[t];
  const auto point = [&](const int i, const int j) { return Vec3(corners[0] + double(i) / n * u + double(j) / n * v); };
  if (surface.labels[t] == 0) {
    for_each_sample(n,
                    [&](const int i, const int j) { colours_[sample++] = to_bytes(paint.skin->colour(point(i, j))); });
    return;
  }
  const InPlane colours(corners, paint);
  const double pixel = paint.inside->pixel();
  for_each_sample(n, [&](const int i, const int j) {
    const Vec3 p = point(i, j);
    colours_[sample] = to_bytes(colours(p));
    if (paint.relief != 0)
      slopes_[sample] = {slope(colours, p, u, paint.relief, pixel), slope(colours, p, v, paint.relief, pixel)};
    ++sample;
  });
}

std::size_t Atlas::n_coarse() const {
  std::size_t n = 0;
  for (std::size_t t = 0; t < parts_.size(); ++t)
    n += parts_[t] == max_parts && longest_side(filled_[t]) > max_parts * resolution_ ? 1 : 0;
  return n;
}

std::size_t Atlas::fill(const SurfaceView& surface, const Paint& paint) {
  const std::size_t n = surface.triangles.size();
  first_.resize(n, none);
  parts_.resize(n, 0);
  filled_.resize(n);
  labels_.resize(n, 0);
  std::vector<std::size_t> fresh;
  std::size_t end = colours_.size();
  for (std::size_t t = 0; t < n; ++t) {
    if (surface.labels[t] == 0 && !paint.skin) {
      first_[t] = none; // it may have been revealed before: later cuts can give a triangle at a rim to the skin
      parts_[t] = 0;
      continue;
    }
    const Corners corners = corners_of(surface, t);
    if (first_[t] != none && filled_[t] == corners && labels_[t] == surface.labels[t])
      continue;
    first_[t] = static_cast<std::uint32_t>(end);
    parts_[t] = static_cast<std::uint16_t>(parts_for(corners, resolution_));
    filled_[t] = corners;
    labels_[t] = surface.labels[t];
    end += n_samples(parts_[t]);
    fresh.push_back(t);
  }
  colours_.resize(end);
  if (paint.relief != 0)
    slopes_.resize(end, {0, 0});
  parallel_for(fresh.size(), [&](const std::size_t i) { fill_triangle(fresh[i], surface, paint); });
  return fresh.size();
}

} // namespace kerf::texture
