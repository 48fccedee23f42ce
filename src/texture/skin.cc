#include "texture/skin.h"

#include <Eigen/Geometry>

#include <cmath>

namespace kerf::texture {

Eigen::Array4f Skin::colour(const Vec3& p) const {
  const Vec3 d = p - centre;
  const double around = std::atan2(axis.cross(meridian).dot(d), meridian.dot(d)) / (2 * M_PI);
  const double down = std::atan2(d.cross(axis).norm(), axis.dot(d)) / M_PI;
  const double column = (around < 0 ? around + 1 : around) * picture.width() - 0.5;
  const double row = down * (picture.height() - 1);
  // The last column goes on into the first.
  const int left = static_cast<int>(std::floor(column));
  const auto share = static_cast<float>(column - left);
  const int w = picture.width();
  const int upper = std::min(static_cast<int>(row), picture.height() - 1);
  const auto lower_share = static_cast<float>(row - upper);
  const auto at = [&](const int c, const int r) { return picture.colours.clamped((c + w) % w, r); };
  const image::Rgb top = at(left, upper) + share * (at(left + 1, upper) - at(left, upper));
  const image::Rgb bottom = at(left, upper + 1) + share * (at(left + 1, upper + 1) - at(left, upper + 1));
  const image::Rgb rgb = top + lower_share * (bottom - top);
  return {rgb[0], rgb[1], rgb[2], image::luminance(rgb)};
}

} // namespace kerf::texture
