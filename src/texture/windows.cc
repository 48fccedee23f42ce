#include "texture/windows.h"

#include <algorithm>
#include <cmath>

namespace kerf::texture {

Windows::Windows(const int width, const int height, const int gutter, const int stride)
  : width_(width),
    gutter_(gutter),
    stride_(stride),
    luminance_(static_cast<std::size_t>(width + 2 * gutter) * (height + 2 * gutter)),
    mean_(static_cast<std::size_t>(width) * height),
    place_(mean_.size()),
    sharpness_(width) {}

/// Calls f(row of values shifted) for each of the 49 shifts.
template <class Function>
void Windows::for_each_shift(const int row, const Function& f) const {
  for (int dr = -window_radius; dr <= window_radius; ++dr)
    for (int dc = -window_radius; dc <= window_radius; ++dc)
      f(&luminance_[index(0, row + dr * stride_)] + dc * stride_);
}

void Windows::find(const int row, const Span& span) {
  constexpr float n = (2 * window_radius + 1) * (2 * window_radius + 1);
  float* const mean = &mean_[inner(0, row)];
  float* const place = &place_[inner(0, row)];
  float* const sharpness = sharpness_.data();
  const float* const own = &luminance_[index(0, row)];
  std::fill(sharpness + span.first, sharpness + span.last + 1, 0.0f);
  for_each_shift(row, [&](const float* value) {
    for (int c = span.first; c <= span.last; ++c) {
      const float v = value[c];
      mean[c] += v;
      sharpness[c] += v * v;
    }
  });
  for (int c = span.first; c <= span.last; ++c) {
    mean[c] /= n;
    const float variance = std::max(0.0f, sharpness[c] / n - mean[c] * mean[c]);
    sharpness[c] = 1 / (0.25f * std::sqrt(variance) + 0.002f);
  }
  for_each_shift(row, [&](const float* value) {
    for (int c = span.first; c <= span.last; ++c)
      place[c] += std::min(std::max((own[c] - value[c]) * sharpness[c] + 0.5f, 0.0f), 1.0f);
  });
  for (int c = span.first; c <= span.last; ++c)
    place[c] /= n;
}

} // namespace kerf::texture
