#pragma once

/// A pinhole camera in the world frame. The view frame has x to the right, y up, and looks along -z.

#include "base/vec.h"

#include <Eigen/Core>

namespace kerf::render {

struct Camera {
  Vec3 eye = {0, -0.5, 0.3}; ///< [m], world
  Vec3 target = {0, 0, 0};   ///< what the centre of the image shows [m], world
  Vec3 up = {0, 0, 1};       ///< world; need not be at right angles to the view
  double field_of_view = 35; ///< vertical [degrees]
  int width = 960, height = 720;
};

/// Throws ParameterError unless the camera can see: eye off the target, up off the view, 0 < field of view < 180.
void check(const Camera& camera);

/// World to view, a rigid motion.
Eigen::Matrix4d view_matrix(const Camera& camera);

/// View to clip space, perspective, for depths [m] between near and far.
Eigen::Matrix4d projection_matrix(const Camera& camera, double near, double far);

} // namespace kerf::render
