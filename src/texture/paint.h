#pragma once

/// Pictures of the inside on planes.

#include "texture/detail.h"

namespace kerf::texture {

/// Pixel (c, r) shows the point origin + c column + r row, rest frame [m].
struct Patch {
  Vec3 origin = Vec3::Zero(), column = Vec3::UnitX(), row = Vec3::UnitY();
  int width = 0, height = 0;

  Vec3 point(const double c, const double r) const { return origin + c * column + r * row; }
};

/// The colours of a patch, and luminance; with small features where `detail` is not null, whose windows are as wide as
/// those of the exemplars. Any number of threads gives the same bits.
image::Raster<Eigen::Array4f> paint(const Interior& interior, const Patch& patch, const Detail* detail,
                                    const Blending& how);
image::Raster<Eigen::Array4f> paint(const Interior& interior, const Patch& patch, const Detail* detail = nullptr);

/// The patch of square pixels that just covers where a plane cuts the body; without pixels where it misses it. Columns
/// run along the frame's x, rows along y. Throws ParameterError for more than 16384 of them along a side.
Patch patch_over(const geometry::TriangleMesh& body, const Frame& frame, double pixel);

/// The patch as a picture: transparent outside of the body.
image::Image picture_of(const Interior& interior, const geometry::TriangleMesh& body, const Patch& patch,
                        const Detail* detail, const Blending& how);

/// Red, green and blue alone.
image::Colours colours_of(const image::Raster<Eigen::Array4f>& painted);

} // namespace kerf::texture
