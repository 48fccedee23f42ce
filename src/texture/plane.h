#pragma once

/// The plane of a section, in the body's rest frame: pixel (c, r) lies at origin + c column + r row.

#include "base/vec.h"

#include <string>

namespace kerf::texture {

class SectionPlane {
 public:
  /// Columns and rows of pixels [m a pixel]. Throws ParameterError about the key "Column [m]" or "Row [m]" if one has
  /// no length, or they are within 1 degree of parallel.
  SectionPlane(const Vec3& origin, const Vec3& column, const Vec3& row);

  const Vec3& origin() const { return origin_; }
  const Vec3& x() const { return x_; } ///< unit, along the columns
  const Vec3& y() const { return y_; } ///< unit, in the plane, at a right angle to x
  const Vec3& normal() const { return normal_; }
  double pixel() const { return pixel_; } ///< side of a square of a pixel's area [m]

  double height(const Vec3& p) const { return normal_.dot(p - origin_); } ///< [m]
  /// Along x and y, from the origin [m].
  Vec2 local(const Vec3& p) const { return Vec2(x_.dot(p - origin_), y_.dot(p - origin_)); }
  Vec3 point(const Vec2& local) const { return origin_ + local[0] * x_ + local[1] * y_; }
  Vec2 to_pixels(const Vec2& local) const { return to_pixels_ * local; }
  Vec2 to_local(const Vec2& pixels) const { return to_local_ * pixels; }
  const Mat2& pixels_by_local() const { return to_pixels_; }

 private:
  Vec3 origin_, x_, y_, normal_;
  Mat2 to_local_, to_pixels_;
  double pixel_;
};

} // namespace kerf::texture
