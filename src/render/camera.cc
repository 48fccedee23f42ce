#include "render/camera.h"

#include "base/error.h"

#include <Eigen/Geometry>

#include <cmath>
#include <numbers>
#include <sstream>

namespace kerf::render {

namespace {

std::string text(const Vec3& v) {
  std::ostringstream out;
  out << v[0] << ", " << v[1] << ", " << v[2];
  return out.str();
}

[[noreturn]] void refuse(const std::string& what, const std::string& value, const std::string& rule,
                         const std::string& remedy) {
  throw ParameterError({.path = "camera " + what, .value = value, .rule = rule, .remedy = remedy});
}

} // namespace

void check(const Camera& camera) {
  const Vec3 view = camera.target - camera.eye;
  if (!(view.allFinite() && view.norm() > 0))
    refuse("eye [m]", text(camera.eye), "must be finite and apart from the target", "Move the eye or the target");
  // 1e-6: below that the horizon is round-off.
  const double off_view = view.normalized().cross(camera.up.normalized()).norm();
  if (!(camera.up.allFinite() && off_view > 1e-6))
    refuse("up", text(camera.up), "must not be parallel to the view", "Choose another up direction");
  if (!(camera.field_of_view > 0 && camera.field_of_view < 180))
    refuse("field of view [degrees]", std::to_string(camera.field_of_view), "must be > 0 and < 180", "Try 35");
  if (camera.width < 1 || camera.height < 1)
    refuse("size [pixels]", std::to_string(camera.width) + " x " + std::to_string(camera.height),
           "width and height must be >= 1", "Try 960 x 720");
}

Eigen::Matrix4d view_matrix(const Camera& camera) {
  const Vec3 back = (camera.eye - camera.target).normalized();
  const Vec3 right = camera.up.cross(back).normalized();
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.block<1, 3>(0, 0) = right.transpose();
  m.block<1, 3>(1, 0) = back.cross(right).transpose();
  m.block<1, 3>(2, 0) = back.transpose();
  m.block<3, 1>(0, 3) = -m.block<3, 3>(0, 0) * camera.eye;
  return m;
}

Eigen::Matrix4d projection_matrix(const Camera& camera, double near, double far) {
  const double scale = 1 / std::tan(camera.field_of_view * std::numbers::pi / 360);
  Eigen::Matrix4d m = Eigen::Matrix4d::Zero();
  m(0, 0) = scale * camera.height / camera.width;
  m(1, 1) = scale;
  m(2, 2) = -(far + near) / (far - near);
  m(2, 3) = -2 * far * near / (far - near);
  m(3, 2) = -1;
  return m;
}

} // namespace kerf::render
