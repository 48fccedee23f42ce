#pragma once

/// Outlines of a section and of a picture of it: what a fit draws to each other (thesis §3.4.2.3).

#include "image/image.h"
#include "warp/fit.h"

#include <vector>

namespace kerf::texture {

/// The outer border of the largest component of a mask, blurred by a pixel so that the steps of the pixels do not
/// count, where it passes a half.
warp::Curve outline_of(const image::Grey& mask);

struct Outlines {
  warp::Curve section, picture; ///< pixels of each mask
  image::Grey within;           ///< what `section` bounds
  double wider = 1;             ///< the box of all that is section, over that of `within`, by their longer sides [1]
  /// The middles, and points of both that lie in the same direction from them, once the affine map between both has
  /// been taken out; empty where one is no star.
  std::vector<warp::Pin> by_rays;
};

/// Outlines of the largest components of two masks where both are stars: rays from their middles pass at most .5 %
/// of their area that is not section, and no more lies in other components. Rays tell the same however a picture is
/// stored, more so than lengths along an outline: where they serve they are taken.
///
/// Elsewhere, outlines after bays and gaps narrower than a twentieth of a mask's size are closed: those are seldom the
/// same in a picture and in the body. Where a mask falls into parts, wider ones, up to a fifth of its size, until nine
/// tenths of both hang together; the largest part alone if they never do.
Outlines outlines_of(const image::Grey& section, const image::Grey& picture);

/// How far apart the outlines lie in the picture once a map has been applied, seen from both [pixels].
warp::Gap gap_after(const warp::LatticeMap& map, const Outlines& outlines);

/// Draws one outline to the other. Cells of the lattice are counted along what `within` bounds.
warp::LatticeMap fitted(const Outlines& outlines, warp::FitOptions options);

} // namespace kerf::texture
