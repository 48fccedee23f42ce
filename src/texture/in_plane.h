#pragma once

/// Small features and relief of triangles that lie in nearly one plane (flat.h).
///
/// What windows see lies on a lattice of points that belongs to the plane, not to a triangle: neighbours in it see the
/// same. It is as fine as the exemplars' pixels; there, source points and weights are found at every eighth point each
/// way, for the cells of the points around it, and are bilinear in between. Colours themselves are found elsewhere, and
/// exact: what small features add to them, and the height of the relief, come from the lattice.

#include "texture/twins.h"
#include "texture/windows.h"

#include <map>

namespace kerf::texture {

class InPlane {
 public:
  enum class Relief { none, wanted };

  /// `detail` may be null: without small features.
  InPlane(const Interior& inside, const Detail* detail, Relief relief)
    : inside_(inside), detail_(detail), relief_(relief), windows_(0, 0, 0, 1) {}

  /// The triangles that are asked about next, and whose plane is that of the first: without an area it has none, and
  /// nothing is added. Others lie next to the plane. Memory is kept for the next ones.
  void lay(std::span<const Corners> triangles);

  /// Where a point of triangles lies on the lattice.
  Eigen::Vector2f on_lattice(const Vec3& p) const {
    return Vec2(x_.dot(p - origin_), y_.dot(p - origin_)).cast<float>() / static_cast<float>(pixel_);
  }
  /// What small features add to red, green and blue at a point of the lattice.
  float change(const Eigen::Vector2f& q) const { return change_.width > 0 ? image::sample(change_, q[0], q[1]) : 0; }
  /// A unit vector in the plane, in points of the lattice.
  Eigen::Vector2f along(const Vec3& unit) const { return Vec2(x_.dot(unit), y_.dot(unit)).cast<float>(); }
  /// By how much the luminance, with small features, rises over two pixels along a vector of along(), midway at a point
  /// of the lattice. Where relief is wanted.
  float rise(const Eigen::Vector2f& q, const Eigen::Vector2f& along) const;

 private:
  /// Eight points of a row, from a multiple of eight on: a bit for each.
  using Lanes = std::uint8_t;
  using Marks = image::Raster<Lanes>;
  using Flat = std::array<Vec2, 3>; ///< a triangle in the plane [points of the lattice]

  void lay_out(std::span<const Corners> triangles, double margin);
  Span span_of(const Flat& triangle, int row, double margin) const;
  void mark(double margin, int radius);
  void find_blends();
  void find_luminance(int row);
  void find_change(int row);
  void find_height(int row);
  /// Four blends around a point of the lattice: of its own cell.
  using Around = std::array<const Blend*, 4>;
  Around nearest(const int i, const int k) const {
    return {&blends_(i, k), &blends_(i + 1, k), &blends_(i, k + 1), &blends_(i + 1, k + 1)};
  }
  const Blend* corner(int i, int k, int cell);
  /// Goes through a row where it is marked, from blend to blend: `block(first column, four blends)` for all points
  /// between these at once, where they belong to one cell; else `point(column, blend)` for each that is marked.
  template <class Block, class Point>
  void for_each_block(int row, const Marks& marks, const Block& block, const Point& point);
  Blend mixed(int column, int row);
  PointRow points(const Around& around, int i, int row) const;
  Vec3 point(const int column, const int row) const { return origin_ + pixel_ * (column * x_ + row * y_); }

  static constexpr int step = n_lanes; ///< points of the lattice from blend to blend

  const Interior& inside_;
  const Detail* detail_;
  Relief relief_;
  Windows windows_;
  Vec3 origin_ = Vec3::Zero(), x_ = Vec3::Zero(), y_ = Vec3::Zero();
  double pixel_ = 1;
  int width_ = 0, height_in_points_ = 0;
  std::vector<Flat> flat_;
  Marks asked_;                                ///< points around triangles, for interpolation and slopes
  Marks reached_;                              ///< those that windows around them reach
  std::vector<Lanes> rows_;                    ///< what is asked for in any of the rows that a window spans
  image::Raster<char> needed_;                 ///< squares between blends where some point is reached
  image::Raster<Blend> blends_;                ///< of every step-th point
  std::map<std::array<int, 3>, Blend> others_; ///< the same for other cells than their own: by column, row, cell
  image::Grey change_, height_;                ///< of the lattice's points; of no width where not wanted
};

} // namespace kerf::texture
