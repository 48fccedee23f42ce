#pragma once

/// Colours in the plane of a triangle, with small features and relief.
///
/// What windows see lies on a lattice of points that belongs to the plane, not to the triangle: neighbours in one plane
/// see the same. It is as fine as the exemplars' pixels; there, source points and weights are found at every sixth
/// point each way, for the cells of the points around it, and are bilinear in between. A colour itself is exact: only
/// what small features add to it, and the height of the relief, come from the lattice.

#include "texture/windows.h"

#include <deque>

namespace kerf::texture {

using Corners = std::array<Vec3, 3>;

class InPlane {
 public:
  enum class Relief { none, wanted };

  /// `detail` may be null: without small features.
  InPlane(const Interior& inside, const Detail* detail, Relief relief, const Corners& corners);

  /// Of a point of the triangle [m].
  Eigen::Array4f colour(const Vec3& p) const;
  /// Luminance with small features where relief is wanted, at most a pixel beside the triangle.
  float height(const Vec3& p) const { return height_.width > 0 ? sample(height_, p) : inside_.colour(p)[3]; }

 private:
  void lay_out(const Corners& corners, double margin);
  Span span_of(const std::array<Vec2, 3>& triangle, int row, double margin) const;
  Span reached(int row, int radius) const;
  void find_blends(const std::vector<Span>& rows);
  void find_luminance(int row, const Span& span, Windows& windows);
  /// The four blends around a point of the lattice, of its own cell.
  using Around = std::array<const Blend*, 4>;
  Around around(int column, int row);
  const Blend* corner(int column, int row, int cell);
  void add_luminance(int row, const Span& span, const Around& around, Windows& windows) const;
  float detail_at(int column, int row, const Detail& detail, float place);
  Vec3 point(const int column, const int row) const { return origin_ + pixel_ * (column * x_ + row * y_); }
  float sample(const image::Grey& lattice, const Vec3& p) const {
    const Vec3 d = (p - origin_) / pixel_;
    return image::sample(lattice, static_cast<float>(x_.dot(d)), static_cast<float>(y_.dot(d)));
  }

  static constexpr int step = 6; ///< points of the lattice from blend to blend

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
