#pragma once

/// The colour of the skin from a picture of all of it: columns run around an axis, rows from its head down, as on a map
/// of the earth.

#include "image/image.h"

namespace kerf::texture {

struct Skin {
  image::Image picture;
  Vec3 centre = Vec3::Zero();    ///< rest frame [m]
  Vec3 axis = Vec3::UnitZ();     ///< unit, through the first row
  Vec3 meridian = Vec3::UnitX(); ///< unit, at a right angle to the axis: where the first column lies

  Eigen::Array4f colour(const Vec3& p) const;
};

} // namespace kerf::texture
