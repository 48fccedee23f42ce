#pragma once

/// The inner loops of small features, on plain pointers, compiled for several instruction sets and chosen at run time.
/// They take eight points side by side.

#include <cstddef>
#include <cstdint>

namespace kerf::texture {

constexpr int n_lanes = 8;
constexpr int window_radius = 3; ///< 7 x 7 points around each

/// Eight points of a picture, evenly apart: weight and place [pixels] of the first one, and from each to the next.
struct PointRow {
  float weight, x, y;
  float weight_step, x_step, y_step;
};

/// Adds the weighted bilinear values of a picture of width x height pixels.
void add_values(const float* picture, int width, int height, const PointRow& points, float* sums);

/// A pixel's distribution as a row of quantiles: signed numbers of 16 bits.
constexpr int n_quantiles = 9;

/// The same for what a distribution has at a place in [0, 1], one a point.
void add_quantiles(const std::int16_t* picture, int width, int height, const PointRow& points, const float* places,
                   float* sums);

/// Of the 7 x 7 points around each, `stride` apart, of rows that are `pitch` numbers long: the mean, and the share of
/// the values below the point's own. That is counted softly, so that it changes continuously: a value within a quarter
/// of the spread counts in part. Reads eight points, and what windows reach beyond them.
void find_windows(const float* luminance, std::ptrdiff_t pitch, std::ptrdiff_t stride, float* means, float* places);

} // namespace kerf::texture
