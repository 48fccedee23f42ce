#pragma once

/// How far two pictures are from each other, and how sharp one is: inside a mask only.

#include "image/image.h"

namespace kerf::image {

/// Shares of the values in equal bins of [0, 1]; values outside count in the end bins. They sum to 1, or are all zero
/// if the mask is empty.
std::vector<double> histogram(const Grey& grey, const Grey& mask, int n_bins);

/// The earth mover's distance between two histograms over [0, 1], in units of the values.
double histogram_distance(const std::vector<double>& a, const std::vector<double>& b);

/// Peak signal to noise ratio [dB] over colours with peak 1; 200 for equal ones.
double psnr(const Colours& a, const Colours& b, const Grey& mask);

/// Mean structural similarity of luminance, Gaussian windows of 1.5 pixels (Wang, Bovik, Sheikh, Simoncelli, 2004),
/// with means inside the mask.
double ssim(const Grey& a, const Grey& b, const Grey& mask);

/// Mean square of the octaves of a picture inside a mask: band k holds what a blur of 2^(k-1) pixels (k = 0: none)
/// keeps and one of 2^k takes away, so wavelengths around 4, 8, 16, ... pixels.
std::vector<double> band_power(const Grey& grey, const Grey& mask, int n_bands);

} // namespace kerf::image
