#pragma once

/// Cubic splines through the pixels of a picture: what is finest fades less between pixels than by bilinear or local
/// cubic interpolation, and pixels keep their values. M. Unser, Splines: a perfect fit for signal and image processing,
/// 1999.

#include "image/image.h"

namespace kerf::image {

/// The coefficients of the spline through a raster of at least 2 x 2 pixels, which goes on mirrored at its border: to
/// be asked by sample_spline(). Of colours, and of four values a pixel.
template <class Value>
Raster<Value> spline_coefficients(const Raster<Value>& raster);
extern template Raster<Rgb> spline_coefficients(const Raster<Rgb>& raster);
extern template Raster<Eigen::Array4f> spline_coefficients(const Raster<Eigen::Array4f>& raster);

} // namespace kerf::image
