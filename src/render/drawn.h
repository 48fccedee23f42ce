#pragma once

/// What an image shows.

#include "base/vec.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace kerf::render {

/// Colours finer than the triangles: triangle t has (n + 1)(n + 2) / 2 samples from first[t] on, n = parts[t], at the
/// points a + i/n (b - a) + j/n (c - a), i slower than j. Without triangles: none.
struct DrawnSamples {
  static constexpr std::uint32_t none = 0xffffffff;     ///< of a triangle without samples
  std::span<const std::uint32_t> first;                 ///< one a triangle
  std::span<const std::uint16_t> parts;                 ///< one a triangle
  std::span<const std::array<std::uint8_t, 3>> colours; ///< sRGB
  std::span<const std::array<float, 2>> slopes;         ///< rise of a relief along (b - a), (c - a) [m]; or empty
};

/// A triangle mesh in its current configuration; the spans must live as long as the call that draws them.
struct DrawnSurface {
  std::span<const Vec3> positions;       ///< [m], world
  std::span<const Triangle> triangles;   ///< counter-clockwise seen from outside
  std::span<const std::uint16_t> labels; ///< one a triangle: 0 skin, k > 0 revealed by cut k; or empty: all skin
  DrawnSamples samples = {};             ///< where a triangle has some, they are its colours
};

/// A steel plate that tapers to its cutting edge.
struct DrawnBlade {
  Points edge; ///< the cutting edge, a polyline [m], world
  Vec3 spine;  ///< from the edge to the back of the plate [m], world
};

/// A round bar of steel: the shank of a handle, an arm, a pin.
struct DrawnRod {
  Points path;       ///< its middle line [m], world
  double radius = 0; ///< [m]
};

/// Everything that an image shows.
struct DrawnScene {
  std::vector<DrawnSurface> surfaces;
  std::vector<DrawnBlade> blades;
  std::vector<DrawnRod> rods;
};

} // namespace kerf::render
