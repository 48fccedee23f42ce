#pragma once

/// Inner loops of source points and small features, on plain pointers, compiled for several instruction sets and chosen
/// at run time. They take eight points side by side: what one gets does not depend on the others.

#include <array>
#include <cstddef>
#include <cstdint>

namespace kerf::texture {

constexpr int n_lanes = 8;
constexpr int window_radius = 3; ///< 7 x 7 points around each

/// Points in space, those beside the plane of a face, distances: one number a point [m].
using Lanes = double[n_lanes];

/// A plane that goes along its normal, and the table of distances to the boundary (source.h).
struct StraightSweep {
  std::array<double, 3> origin, x, y, forward; ///< `forward`: the normal on the side where the plane goes
  double steps_by_t = 0;                       ///< rows of the table a metre
  int n_steps = 0, n_directions = 0;
  double far = 0;             ///< [steps], see below
  const float* squared_radii; ///< n_steps rows of n_directions + 1 [m^2]
  const double* middles;      ///< two numbers a row [m]
};

/// Source points in coordinates of the plane, and how far they are from the points that ask [m]: the same as
/// Source::find(), to round-off.
void find_source_points(const StraightSweep& sweep, const Lanes* points, Lanes& x, Lanes& y, Lanes& distances);

/// Shares of n source points by Shepard: n rows of distances [m] and of shares. The power is 1 or 2.
void find_shares(int n, int power, const Lanes* distances, Lanes* shares);

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
