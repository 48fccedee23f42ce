#pragma once

/// Outlines of a section and of a picture of it: what a fit draws to each other (thesis §3.4.2.3).

#include "image/image.h"
#include "warp/curve.h"

namespace kerf::texture {

/// The outer border of the largest component of a mask, blurred by a pixel so that the steps of the pixels do not
/// count, where it passes a half.
warp::Curve outline_of(const image::Grey& mask);

struct Outlines {
  warp::Curve section, picture; ///< pixels of each mask
  image::Grey within;           ///< what `section` bounds
};

/// Outlines of two masks after bays and gaps narrower than a twentieth of their size are closed: those are seldom the
/// same in a picture and in the body. Where a mask falls into parts, wider ones, up to a fifth of its size, until nine
/// tenths of both hang together; the largest part alone if they never do.
Outlines outlines_of(const image::Grey& section, const image::Grey& picture);

} // namespace kerf::texture
