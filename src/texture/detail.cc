#include "texture/detail.h"

#include "base/parallel.h"

#include <algorithm>
#include <cmath>

namespace kerf::texture {

namespace {

constexpr int window = 2 * window_radius + 1, n_in_window = window * window, n_steps = n_quantiles - 1;
constexpr float units = 16384; ///< of the stored numbers: a difference of luminance of 1

} // namespace

LocalHistograms::LocalHistograms(const Chart& chart)
  : quantiles_(chart.colours.width, chart.colours.height, Quantiles()) {
  parallel_for(static_cast<std::size_t>(quantiles_.height), [&](const std::size_t row) {
    const int r = static_cast<int>(row);
    std::array<float, n_in_window> values;
    for (int c = 0; c < quantiles_.width; ++c) {
      float sum = 0;
      auto* value = values.begin();
      for (int dr = -window_radius; dr <= window_radius; ++dr)
        for (int dc = -window_radius; dc <= window_radius; ++dc) {
          *value = chart.colours.clamped(c + dc, r + dr)[3];
          sum += *value++;
        }
      std::sort(values.begin(), values.end());
      for (int k = 0; k < n_quantiles; ++k) {
        const float difference = values[k * (n_in_window - 1) / n_steps] - sum / n_in_window;
        quantiles_(c, r)[k] = static_cast<std::int16_t>(std::lround(units * difference));
      }
    }
  });
}

float LocalHistograms::at(const float x, const float y, const float place) const {
  const image::Footing f = image::footing(quantiles_.width, quantiles_.height, x, y);
  const float number = place * n_steps;
  const int k = std::min(static_cast<int>(number), n_steps - 1);
  const float u = number - static_cast<float>(k);
  const auto value = [&](const Quantiles& q) {
    return (1 - u) * static_cast<float>(q[k]) + u * static_cast<float>(q[k + 1]);
  };
  const Quantiles* const p = &quantiles_.values[quantiles_.index(f.column, f.row)];
  const Quantiles* const q = p + quantiles_.width;
  const float top = value(p[0]) + f.right * (value(p[1]) - value(p[0]));
  const float bottom = value(q[0]) + f.right * (value(q[1]) - value(q[0]));
  return (top + f.down * (bottom - top)) / units;
}

void LocalHistograms::add(PointRow points, const float* const places, float* const sums) const {
  points.weight /= units;
  points.weight_step /= units;
  add_quantiles(quantiles_.values.front().data(), quantiles_.width, quantiles_.height, points, places, sums);
}

Detail::Detail(const Interior& interior) {
  for (const Chart& chart : interior.charts())
    histograms_.emplace_back(chart);
}

float Detail::luminance(const Blend& blend, const float place) const {
  float sum = 0;
  for (int i = 0; i < blend.n; ++i)
    sum += blend.weights[i] * histograms_[blend.exemplars[i]].at(blend.x[i], blend.y[i], place);
  return sum;
}

} // namespace kerf::texture
