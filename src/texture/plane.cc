#include "texture/plane.h"

#include "base/error.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <cmath>

namespace kerf::texture {

namespace {

void check(const Vec3& column, const Vec3& row) {
  const auto refuse = [](const std::string& key, const std::string& rule) {
    throw ParameterError(Complaint{
      .path = key, .rule = rule, .remedy = "Give the steps from pixel to pixel along a column and along a row"});
  };
  if (!(column.norm() > 1e-12))
    refuse("Column [m]", "must have a length");
  if (!(row.norm() > 1e-12))
    refuse("Row [m]", "must have a length");
  if (column.cross(row).norm() < 0.017 * column.norm() * row.norm())
    refuse("Row [m]", "is parallel to the column: the two span no plane");
}

} // namespace

SectionPlane::SectionPlane(const Vec3& origin, const Vec3& column, const Vec3& row) : origin_(origin) {
  check(column, row);
  x_ = column.normalized();
  y_ = (row - row.dot(x_) * x_).normalized();
  normal_ = x_.cross(y_);
  to_local_ << column.norm(), row.dot(x_), 0, row.dot(y_);
  to_pixels_ = to_local_.inverse();
  pixel_ = std::sqrt(std::abs(to_local_.determinant()));
}

} // namespace kerf::texture
