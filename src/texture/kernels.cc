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

__attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default"))) void find_source_points(
  const StraightSweep& sweep, const Lanes* const points, Lanes& __restrict x, Lanes& __restrict y,
  Lanes& __restrict distances) {
  alignas(64) double forward[n_lanes], across[n_lanes], down[n_lanes], steps[n_lanes], part[n_lanes];
  alignas(64) std::int32_t row[n_lanes], column[n_lanes];
  const double last = sweep.n_steps - 1 - 1e-9;
  for (int l = 0; l < n_lanes; ++l) {
    const double a = points[0][l] - sweep.origin[0], b = points[1][l] - sweep.origin[1],
                 c = points[2][l] - sweep.origin[2];
    forward[l] = sweep.forward[0] * a + sweep.forward[1] * b + sweep.forward[2] * c;
    across[l] = sweep.x[0] * a + sweep.x[1] * b + sweep.x[2] * c;
    down[l] = sweep.y[0] * a + sweep.y[1] * b + sweep.y[2] * c;
    double step = forward[l] * sweep.steps_by_t;
    step = step > 0 ? step : 0;
    steps[l] = step < last ? step : last;
    row[l] = static_cast<std::int32_t>(steps[l]);
  }
  alignas(64) double middles[n_lanes][4]; // of the rows before and behind
  for (int l = 0; l < n_lanes; ++l)
    std::memcpy(middles[l], sweep.middles + 2 * row[l], sizeof middles[l]);
  alignas(64) double arm_x[n_lanes], arm_y[n_lanes];
  for (int l = 0; l < n_lanes; ++l) {
    const double s = steps[l] - row[l];
    arm_x[l] = across[l] - ((1 - s) * middles[l][0] + s * middles[l][2]);
    arm_y[l] = down[l] - ((1 - s) * middles[l][1] + s * middles[l][3]);
    // direction_number()
    const double sum = std::abs(arm_x[l]) + std::abs(arm_y[l]);
    const double sine = arm_y[l] / (sum > 1e-300 ? sum : 1e-300);
    const double right = sine >= 0 ? sine : 4 + sine;
    double number = (arm_x[l] >= 0 ? right : 2 - sine) * (0.25 * sweep.n_directions);
    number = number < sweep.n_directions ? number : 0;
    column[l] = static_cast<std::int32_t>(number);
    part[l] = number - column[l];
  }
  alignas(64) float own[2 * n_lanes], before[2 * n_lanes], behind[2 * n_lanes];
  for (int l = 0; l < n_lanes; ++l) {
    const float* const radii = sweep.squared_radii + column[l];
    const float* const at = radii + static_cast<std::ptrdiff_t>(row[l]) * (sweep.n_directions + 1);
    std::memcpy(own + 2 * l, radii, 2 * sizeof(float));
    std::memcpy(before + 2 * l, at, 2 * sizeof(float));
    std::memcpy(behind + 2 * l, at + sweep.n_directions + 1, 2 * sizeof(float));
  }
  alignas(64) double squared_ratio[n_lanes];
  for (int l = 0; l < n_lanes; ++l) {
    const auto squared = [&](const float* const pairs) {
      return (1 - part[l]) * pairs[2 * l] + part[l] * pairs[2 * l + 1];
    };
    const double s = steps[l] - row[l];
    const double here = squared(own), there = (1 - s) * squared(before) + s * squared(behind);
    const double reach = (steps[l] + sweep.far) * (steps[l] + sweep.far) * there;
    const double length = (arm_x[l] * arm_x[l] + arm_y[l] * arm_y[l]) * steps[l] * steps[l];
    squared_ratio[l] = here / there * (reach / (length > reach ? length : reach));
  }
  const double middle_x = sweep.middles[0], middle_y = sweep.middles[1];
  for (int l = 0; l < n_lanes; ++l) {
    const double ratio = std::sqrt(squared_ratio[l]);
    x[l] = middle_x + ratio * arm_x[l];
    y[l] = middle_y + ratio * arm_y[l];
    const double a = x[l] - across[l], b = y[l] - down[l];
    distances[l] = std::sqrt(forward[l] * forward[l] + (a * a + b * b));
  }
}

__attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default"))) void find_shares(
  const int n, const int power, const Lanes* const distances, Lanes* const __restrict shares) {
  alignas(64) double largest[n_lanes] = {}, sums[n_lanes] = {};
  for (int i = 0; i < n; ++i)
    for (int l = 0; l < n_lanes; ++l)
      largest[l] = distances[i][l] > largest[l] ? distances[i][l] : largest[l];
  for (int i = 0; i < n; ++i) {
    alignas(64) double share[n_lanes];
    for (int l = 0; l < n_lanes; ++l) {
      const double d = distances[i][l] + (1e-12 * largest[l] + 1e-300), product = power == 1 ? d : d * d;
      share[l] = 1 / product;
      sums[l] += share[l];
    }
    std::memcpy(shares[i], share, sizeof share);
  }
  for (int i = 0; i < n; ++i)
    for (int l = 0; l < n_lanes; ++l)
      shares[i][l] /= sums[l];
}

__attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default"))) void add_values(
  const float* const picture, const int width, const int height, const PointRow& points, float* const __restrict sums) {
  const Footings f = footings(width, height, points);
  alignas(64) float upper[2 * n_lanes], lower[2 * n_lanes];
  for (int l = 0; l < n_lanes; ++l) {
    std::memcpy(upper + 2 * l, picture + f.index[l], 2 * sizeof(float));
    std::memcpy(lower + 2 * l, picture + f.index[l] + width, 2 * sizeof(float));
  }
  for (int l = 0; l < n_lanes; ++l) {
    const float top = upper[2 * l] + f.right[l] * (upper[2 * l + 1] - upper[2 * l]);
    const float bottom = lower[2 * l] + f.right[l] * (lower[2 * l + 1] - lower[2 * l]);
    sums[l] += f.weight[l] * (top + f.down[l] * (bottom - top));
  }
}

__attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default"))) void add_quantiles(
  const std::int16_t* const picture, const int width, const int height, const PointRow& points,
  const float* const places, float* const __restrict sums) {
  const Footings f = footings(width, height, points);
  constexpr int n_steps = n_quantiles - 1;
  alignas(64) std::int32_t first[n_lanes]; // the lower quantile of the upper left pixel
  alignas(64) float share[n_lanes];
  for (int l = 0; l < n_lanes; ++l) {
    const float number = places[l] * n_steps;
    auto k = static_cast<std::int32_t>(number);
    k = k < n_steps - 1 ? k : n_steps - 1;
    share[l] = number - static_cast<float>(k);
    first[l] = n_quantiles * f.index[l] + k;
  }
  // Two quantiles at once, of the four pixels around each point.
  alignas(64) std::int32_t a[n_lanes], b[n_lanes], c[n_lanes], d[n_lanes];
  for (int l = 0; l < n_lanes; ++l) {
    const std::int16_t* const p = picture + first[l];
    const std::int16_t* const q = p + static_cast<std::ptrdiff_t>(n_quantiles) * width;
    std::memcpy(a + l, p, sizeof *a);
    std::memcpy(b + l, p + n_quantiles, sizeof *b);
    std::memcpy(c + l, q, sizeof *c);
    std::memcpy(d + l, q + n_quantiles, sizeof *d);
  }
  const auto value = [&share](const std::int32_t* const pairs, const int l) {
    const auto low = static_cast<float>(static_cast<std::int32_t>(static_cast<std::uint32_t>(pairs[l]) << 16) >> 16);
    const auto high = static_cast<float>(pairs[l] >> 16);
    return low + share[l] * (high - low);
  };
  for (int l = 0; l < n_lanes; ++l) {
    const float upper = value(a, l), lower = value(c, l);
    const float top = upper + f.right[l] * (value(b, l) - upper), bottom = lower + f.right[l] * (value(d, l) - lower);
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
