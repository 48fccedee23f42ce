#pragma once

/// Pictures in memory.
///
/// Pixel (c, r) is a sample at the point (c, r): columns run to the right, rows down. Values between pixels are
/// bilinear; outside, the nearest pixel of the border counts. Colours are those of the file (sRGB for photographs), in
/// [0, 1].

#include "base/vec.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace kerf::image {

using Rgb = Eigen::Array3f;

/// One value a pixel, of any meaning.
template <class Value>
struct Raster {
  int width = 0, height = 0;
  std::vector<Value> values; ///< row by row, width * height

  Raster() = default;
  Raster(const int w, const int h, const Value& value)
    : width(w), height(h), values(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), value) {}

  std::size_t index(const int column, const int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column);
  }
  const Value& operator()(const int column, const int row) const { return values[index(column, row)]; }
  Value& operator()(const int column, const int row) { return values[index(column, row)]; }

  /// As if the border's pixels went on for ever.
  const Value& clamped(const int column, const int row) const {
    return (*this)(std::clamp(column, 0, width - 1), std::clamp(row, 0, height - 1));
  }
};

using Grey = Raster<float>;
using Colours = Raster<Rgb>;

/// Colours and how much of each pixel is there.
struct Image {
  Colours colours;
  Grey alpha;         ///< in [0, 1]; without pixels where the file has none: all is there
  int n_channels = 3; ///< of the file: 1 grey, 3 colour
  int bits = 8;       ///< of the file, a channel

  int width() const { return colours.width; }
  int height() const { return colours.height; }
  bool has_alpha() const { return alpha.width > 0; }
};

/// Where a point lies in a raster with at least 2 x 2 pixels: its lower pixel and the shares of the next ones.
struct Footing {
  int column = 0, row = 0;
  float right = 0, down = 0; ///< in [0, 1]
};

inline Footing footing(const int width, const int height, const float x, const float y) {
  const float u = std::min(std::max(x, 0.0f), static_cast<float>(width - 1));
  const float v = std::min(std::max(y, 0.0f), static_cast<float>(height - 1));
  const int column = std::min(static_cast<int>(u), width - 2), row = std::min(static_cast<int>(v), height - 2);
  return {column, row, u - static_cast<float>(column), v - static_cast<float>(row)};
}

/// The bilinear value at a point [pixels].
template <class Value>
Value sample(const Raster<Value>& raster, const float x, const float y) {
  const Footing f = footing(raster.width, raster.height, x, y);
  const Value* const p = &raster.values[raster.index(f.column, f.row)];
  const Value* const q = p + raster.width;
  const Value top = p[0] + f.right * (p[1] - p[0]), bottom = q[0] + f.right * (q[1] - q[0]);
  return top + f.down * (bottom - top);
}

/// Shares of four neighbours at a place in [0, 1] between the middle ones: those of a cubic B-spline.
inline std::array<float, 4> spline_shares(const float t) {
  const float u = 1 - t;
  return {u * u * u / 6, (4 + t * t * (3 * t - 6)) / 6, (4 + u * u * (3 * u - 6)) / 6, t * t * t / 6};
}

/// The value at a point [pixels] of the cubic spline with these coefficients (spline.h). It may leave the range of the
/// pixels.
template <class Value>
Value sample_spline(const Raster<Value>& coefficients, const float x, const float y) {
  const Footing f = footing(coefficients.width, coefficients.height, x, y);
  const auto across = spline_shares(f.right), down = spline_shares(f.down);
  // Mirrored at the border.
  const Value* const middle = &coefficients.values[coefficients.index(f.column, f.row)];
  const int left = f.column > 0 ? -1 : 1, right = f.column + 2 < coefficients.width ? 2 : 0;
  const auto row = [&](const int k) {
    const Value* const p = middle + k * coefficients.width;
    return Value(across[0] * p[left] + across[1] * p[0] + across[2] * p[1] + across[3] * p[right]);
  };
  return down[0] * row(f.row > 0 ? -1 : 1) + down[1] * row(0) + down[2] * row(1) +
         down[3] * row(f.row + 2 < coefficients.height ? 2 : 0);
}

/// How bright a colour looks: Rec. 709 weights, on the values as they are.
inline float luminance(const Rgb& c) { return 0.2126f * c[0] + 0.7152f * c[1] + 0.0722f * c[2]; }
Grey luminance(const Colours& colours);

} // namespace kerf::image
