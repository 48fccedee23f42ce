#pragma once

/// Colours in the plane of a triangle, with small features and relief.
///
/// What windows see lies on a lattice of points that belongs to the plane, not to the triangle: neighbours in one plane
/// see the same. It is as fine as the exemplars' pixels; there, source points and weights are found at every eighth
/// point each way, for the cells of the points around it, and are bilinear in between. A colour itself is exact: only
/// what small features add to it, and the height of the relief, come from the lattice.

#include "texture/twins.h"
#include "texture/windows.h"

#include <deque>

namespace kerf::texture {

class InPlane {
 public:
  enum class Relief { none, wanted };

  /// `detail` may be null: without small features.
  InPlane(const Interior& inside, const Detail* detail, Relief relief, const Corners& corners);

  /// Of a point of the triangle [m].
  Eigen::Array4f colour(const Vec3& p) const;
  /// By how much the luminance, with small features, rises over two pixels along a unit vector in the plane, midway at a
  /// point of the triangle [m]. Where relief is wanted.
  float rise(const Vec3& p, const Vec3& along) const;

 private:
  void lay_out(const Corners& corners, double margin);
  Span span_of(const std::array<Vec2, 3>& triangle, int row, double margin) const;
  Span reached(int row, int radius) const;
  void find_blends(const std::vector<Span>& rows);
  void find_luminance(int row, const Span& span, Windows& windows);
  void find_change(int row, const Detail& detail, const Windows& windows);
  void find_height(int row, const Windows& windows);
  /// Four blends around a point of the lattice: of its own cell.
  using Around = std::array<const Blend*, 4>;
  Around nearest(const int i, const int k) const {
    return {&blends_(i, k), &blends_(i + 1, k), &blends_(i, k + 1), &blends_(i + 1, k + 1)};
  }
  const Blend* corner(int i, int k, int cell);
  /// Goes through a span of a row, from blend to blend: `block(first column, four blends)` for all points between these
  /// at once, where they belong to one cell; else `point(column, blend)` for each.
  template <class Block, class Point>
  void for_each_block(int row, const Span& span, const Block& block, const Point& point);
  Blend mixed(int column, int row);
  PointRow points(const Around& around, int i, int row) const;
  Vec3 point(const int column, const int row) const { return origin_ + pixel_ * (column * x_ + row * y_); }
  Vec2 on_lattice(const Vec3& p) const { return Vec2(x_.dot(p - origin_), y_.dot(p - origin_)) / pixel_; }

  static constexpr int step = 8; ///< points of the lattice from blend to blend, at most n_lanes

  const Interior& inside_;
  Vec3 origin_ = Vec3::Zero(), x_ = Vec3::Zero(), y_ = Vec3::Zero();
  double pixel_ = 1;
  int width_ = 0, height_in_points_ = 0;
  std::vector<Span> spans_;     ///< of each row, what is asked for
  image::Raster<Blend> blends_; ///< of every step-th point
  struct Other {
    int column, row;
    Blend blend;
  };
  std::deque<Other> others_;    ///< of the same for other cells than their own
  image::Grey change_, height_; ///< of the lattice's points; without pixels where not wanted
};

} // namespace kerf::texture
