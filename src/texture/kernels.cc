#include "texture/kernels.h"

#include <cmath>
#include <cstring>

namespace kerf::texture {

namespace {

/// Where eight points lie in a picture: the index of the lower pixel, the shares of the next ones, the weight.
struct Footings {
  alignas(64) std::int32_t index[n_lanes];
  alignas(64) float right[n_lanes], down[n_lanes], weight[n_lanes];
};

[[gnu::always_inline]] inline Footings footings(const int width, const int height, const PointRow& points) {
  Footings f;
  const float last_x = static_cast<float>(width - 1), last_y = static_cast<float>(height - 1);
  for (int l = 0; l < n_lanes; ++l) {
    const auto step = static_cast<float>(l);
    float x = points.x + step * points.x_step, y = points.y + step * points.y_step;
    x = x > 0 ? x : 0;
    y = y > 0 ? y : 0;
    x = x < last_x ? x : last_x;
    y = y < last_y ? y : last_y;
    auto column = static_cast<std::int32_t>(x), row = static_cast<std::int32_t>(y);
    column = column < width - 2 ? column : width - 2;
    row = row < height - 2 ? row : height - 2;
    f.index[l] = row * width + column;
    f.right[l] = x - static_cast<float>(column);
    f.down[l] = y - static_cast<float>(row);
    f.weight[l] = points.weight + step * points.weight_step;
  }
  return f;
}

constexpr int window = 2 * window_radius + 1, most_stride = 8;
constexpr float n_in_window = window * window;

/// Means of the windows, and one over the width of the step in which a value begins to count.
[[gnu::always_inline]] inline void find_means(const float* const luminance, const std::ptrdiff_t pitch,
                                              const std::ptrdiff_t stride, float* const means, float* const sharpness) {
  constexpr int n_columns = n_lanes * (1 + 2 * window_radius * most_stride / n_lanes);
  alignas(64) float sums[n_columns], squares[n_columns]; // of each column of the windows
  const std::ptrdiff_t n = n_lanes * ((n_lanes + 2 * window_radius * stride + n_lanes - 1) / n_lanes);
  const float* const first = luminance - window_radius * stride;
  for (std::ptrdiff_t block = 0; block < n; block += n_lanes) {
    float s[n_lanes] = {}, q[n_lanes] = {};
    for (int r = -window_radius; r <= window_radius; ++r)
      for (int l = 0; l < n_lanes; ++l) {
        const float v = first[r * stride * pitch + block + l];
        s[l] += v;
        q[l] += v * v;
      }
    for (int l = 0; l < n_lanes; ++l) {
      sums[block + l] = s[l];
      squares[block + l] = q[l];
    }
  }
  for (int l = 0; l < n_lanes; ++l) {
    float s = 0, q = 0;
    for (int k = 0; k < window; ++k) {
      s += sums[l + k * stride];
      q += squares[l + k * stride];
    }
    means[l] = s / n_in_window;
    const float variance = q / n_in_window - means[l] * means[l];
    sharpness[l] = 1 / (0.25f * std::sqrt(variance > 0 ? variance : 0) + 0.002f);
  }
}

} // namespace

__attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default"))) void add_values(
  const float* const picture, const int width, const int height, const PointRow& points, float* const __restrict sums) {
  const Footings f = footings(width, height, points);
  for (int l = 0; l < n_lanes; ++l) {
    const float* const p = picture + f.index[l];
    const float top = p[0] + f.right[l] * (p[1] - p[0]);
    const float bottom = p[width] + f.right[l] * (p[width + 1] - p[width]);
    sums[l] += f.weight[l] * (top + f.down[l] * (bottom - top));
  }
}

__attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default"))) void add_quantiles(
  const std::int16_t* const picture, const int width, const int height, const PointRow& points,
  const float* const places, float* const __restrict sums) {
  const Footings f = footings(width, height, points);
  for (int l = 0; l < n_lanes; ++l) {
    constexpr int n_steps = n_quantiles - 1;
    const float number = places[l] * n_steps;
    auto k = static_cast<std::int32_t>(number);
    k = k < n_steps - 1 ? k : n_steps - 1;
    const float share = number - static_cast<float>(k);
    const std::int16_t* const p = picture + n_quantiles * f.index[l] + k;
    const auto value = [share](const std::int16_t* const two) {
      std::uint32_t pair; // both at once
      std::memcpy(&pair, two, sizeof pair);
      const auto low = static_cast<float>(static_cast<std::int32_t>(pair << 16) >> 16);
      const auto high = static_cast<float>(static_cast<std::int32_t>(pair) >> 16);
      return low + share * (high - low);
    };
    const float a = value(p), b = value(p + n_quantiles);
    const float c = value(p + n_quantiles * width), d = value(p + n_quantiles * (width + 1));
    const float top = a + f.right[l] * (b - a), bottom = c + f.right[l] * (d - c);
    sums[l] += f.weight[l] * (top + f.down[l] * (bottom - top));
  }
}

__attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default"))) void find_windows(
  const float* const luminance, const std::ptrdiff_t pitch, const std::ptrdiff_t stride, float* const means,
  float* const places) {
  alignas(64) float own[n_lanes], sharpness[n_lanes], below[n_lanes] = {};
  find_means(luminance, pitch, stride, means, sharpness);
  for (int l = 0; l < n_lanes; ++l)
    own[l] = luminance[l] * sharpness[l] + 0.5f;
  for (int r = -window_radius; r <= window_radius; ++r)
    for (int c = -window_radius; c <= window_radius; ++c) {
      const float* const values = luminance + r * stride * pitch + c * stride;
      for (int l = 0; l < n_lanes; ++l) {
        const float part = own[l] - values[l] * sharpness[l];
        const float floored = part > 0 ? part : 0;
        below[l] += floored < 1 ? floored : 1;
      }
    }
  for (int l = 0; l < n_lanes; ++l)
    places[l] = below[l] / n_in_window;
}

} // namespace kerf::texture
