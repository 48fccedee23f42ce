#pragma once

/// How far pixels lie from a mask.

#include "image/image.h"

namespace kerf::image {

/// Squared distance of each pixel to the nearest whose mask is above a half [pixels^2]; at least 1e12 where none is.
/// Exact: lower envelopes of parabolas along columns, then rows (Felzenszwalb and Huttenlocher, Distance transforms of
/// sampled functions, 2012).
Raster<double> squared_distances(const Grey& mask);

/// A mask with every place added that no disk of this radius [pixels] reaches from outside: bays and gaps narrower than
/// twice the radius.
Grey closed(const Grey& mask, double radius);

} // namespace kerf::image
