#pragma once

/// Small features (thesis §3.4.3.3): what a blend of several exemplars has lost is put back by matching local
/// histograms.
///
/// Beforehand, each pixel of an exemplar gets the distribution of luminance about its mean in the 7 x 7 pixels around
/// it, as quantiles. A point of a surface gets the same of the 7 x 7 points around it *on the surface*; its own place
/// in that distribution picks the value at the same place in the exemplars' distributions, mixed by their weights.

#include "texture/interior.h"
#include "texture/kernels.h"

namespace kerf::texture {

class LocalHistograms {
 public:
  explicit LocalHistograms(const Chart& chart);

  /// The value at a place in [0, 1] of the distribution around a point [pixels]: bilinear between pixels.
  float at(float x, float y, float place) const;
  /// Adds those of eight points, weighted, each at a place of its own.
  void add(PointRow points, const float* places, float* sums) const;

 private:
  using Quantiles = std::array<std::int16_t, n_quantiles>;
  image::Raster<Quantiles> quantiles_;
};

/// The small features of all exemplars of an interior.
class Detail {
 public:
  explicit Detail(const Interior& interior);

  /// The luminance about the local mean that a point with this blend, at this place of its window's distribution,
  /// should have.
  float luminance(const Blend& blend, float place) const;

  const LocalHistograms& histograms(const int exemplar) const { return histograms_[exemplar]; }

 private:
  std::vector<LocalHistograms> histograms_;
};

} // namespace kerf::texture
