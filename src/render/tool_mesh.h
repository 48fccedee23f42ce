#pragma once

/// Solids that stand for tools in an image.

#include "base/vec.h"

#include <cstdint>
#include <vector>

namespace kerf::render {

struct ToolMesh {
  Points positions; ///< [m]
  std::vector<Triangle> triangles;
  std::vector<std::uint16_t> labels; ///< one a triangle: neighbours with different ones meet in a sharp edge
};

/// A polyline without points that repeat the one before.
Points without_repeats(const Points& polyline);

} // namespace kerf::render
