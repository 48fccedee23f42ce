#include "render/camera.h"

#include "base/error.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <limits>
#include <numbers>

namespace kerf::render::camera_test {
namespace {

TEST(Camera, ViewIsARigidMotionThatLooksDownMinusZ) {
  const Camera camera{.eye = {1, 2, 3}, .target = {-2, 0.5, 1}, .up = {0.1, 0, 1}};
  const Eigen::Matrix4d view = view_matrix(camera);
  const Mat3 rotation = view.block<3, 3>(0, 0);
  EXPECT_LT((rotation * rotation.transpose() - Mat3::Identity()).norm(), 1e-14);
  EXPECT_GT(rotation.determinant(), 0);
  const Vec3 target = (view * camera.target.homogeneous()).head<3>();
  EXPECT_LT((target - Vec3(0, 0, -(camera.target - camera.eye).norm())).norm(), 1e-14);
  const Vec3 up = rotation * camera.up;
  EXPECT_NEAR(up.x(), 0, 1e-14);
  EXPECT_GT(up.y(), 0);
}

TEST(Camera, ProjectionPutsTheFieldOfViewAndThePlanesOnTheBorders) {
  const Camera camera{.field_of_view = 50, .width = 200, .height = 100};
  const Eigen::Matrix4d projection = projection_matrix(camera, 0.5, 4);
  const double rise = std::tan(25 * std::numbers::pi / 180);
  const auto project = [&](const Vec3& p) { return Vec3((projection * p.homogeneous()).hnormalized()); };
  EXPECT_LT((project({0, 0.5 * rise, -0.5}) - Vec3(0, 1, -1)).norm(), 1e-13);
  EXPECT_LT((project({8 * rise, 0, -4}) - Vec3(1, 0, 1)).norm(), 1e-13);
}

TEST(Camera, RefusesWhatCannotSee) {
  EXPECT_NO_THROW(check(Camera{}));
  EXPECT_THROW(check(Camera{.eye = {0, 0, 0}, .target = {0, 0, 0}}), ParameterError);
  EXPECT_THROW(check(Camera{.eye = {0, 0, 1}, .target = {0, 0, 0}, .up = {0, 0, 2}}), ParameterError);
  EXPECT_THROW(check(Camera{.up = {0, 0, 0}}), ParameterError);
  EXPECT_THROW(check(Camera{.eye = {std::numeric_limits<double>::quiet_NaN(), 0, 0}}), ParameterError);
  EXPECT_THROW(check(Camera{.field_of_view = 180}), ParameterError);
  EXPECT_THROW(check(Camera{.width = 0}), ParameterError);
}

} // namespace
} // namespace kerf::render::camera_test
