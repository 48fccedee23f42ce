#pragma once

/// All triangles of an image in one array, as the vertex shaders read them.

#include "render/camera.h"
#include "render/drawn.h"
#include "render/look.h"

#include <Eigen/Geometry>

#include <cstdint>
#include <span>
#include <vector>

namespace kerf::render {

struct Batch {
  /// Floats a vertex: position 3 and unit normal 3 in the view frame, linear colour 3, metal 1 (0 tissue, 1 steel).
  static constexpr std::size_t n_floats = 10;

  std::vector<float> vertices;
  std::vector<std::uint32_t> indices;
  Eigen::AlignedBox3d bounds; ///< view frame [m]
};

/// Throws DataError if a triangle names no vertex or the labels do not fit, NumericalError if a position is not finite.
Batch collect(const Camera& camera, const Look& look, const DrawnScene& scene);

} // namespace kerf::render
