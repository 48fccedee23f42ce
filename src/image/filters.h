#pragma once

/// Blurs, stacks, pyramids, edges, and values for what is missing.

#include "image/image.h"

namespace kerf::image {

/// Gaussian blur of standard deviation sigma [pixels]; what lies outside counts as the border's pixels. 0: as it is.
Grey blurred(const Grey& grey, double sigma);
Colours blurred(const Colours& colours, double sigma);

/// The blur of what a mask lets through, divided by the blur of the mask: nothing from outside it leaks in. Zero where
/// the mask is out of reach.
Grey blurred_inside(const Grey& grey, const Grey& mask, double sigma);

/// Level k is blurred by sigma_k = 2^(k-1) pixels, level 0 not at all; all levels keep the size (Lefebvre and Hoppe
/// 2005, which the thesis cites in §3.4.3.1).
std::vector<Colours> gaussian_stack(const Colours& colours, int n_levels);

/// Level 0 is the image; each level is the one before it, blurred and with every second pixel left out; down to 2
/// pixels.
std::vector<Grey> pyramid(const Grey& grey, int n_levels);

/// The value between pixels for another size: pixel (c, r) of the result lies at the same part of the width and height.
Grey resized(const Grey& grey, int width, int height);

/// With n pixels of nothing around it.
Grey padded(const Grey& grey, int n);

/// How fast the colour changes [1/pixel]: the largest singular value of the gradients of the three channels (Di Zenzo,
/// A note on the gradient of a multi-image, 1986), by central differences.
Grey edge_strength(const Colours& colours);

/// Pixels whose mask is below a half get values that go on smoothly from the others: averages at coarser and coarser
/// levels where there is nothing near (Gortler et al., The lumigraph, 1996: push and pull). Masks without any
/// pixel leave zeros.
Colours filled(const Colours& colours, const Grey& mask);

} // namespace kerf::image
