#pragma once

/// Outlines of masks, and which points of two outlines belong together: what a fit pins (thesis §3.4.2.3).

#include "image/image.h"
#include "warp/energy.h"

#include <vector>

namespace kerf::texture {

/// A closed curve [pixels]; its last point is followed by the first.
using Outline = std::vector<Vec2>;

/// The outer border of the largest component of a mask, blurred by a pixel so that the steps of the pixels do not
/// count, where it passes a half.
Outline outline_of(const image::Grey& mask);

/// Whether every ray from `centre` leaves an outline once, undercuts of `least` pixels left aside.
bool is_star(const Outline& outline, const Vec2& centre, double least = 2);

/// n points at equal steps along an outline, the first of them its first.
Outline equally_spaced(const Outline& outline, int n);

/// Points of two outlines at equal parts of their lengths, from where they lie over each other best when they are moved
/// and scaled but not turned: their pictures are placed already.
std::vector<warp::Pin> pairs_along(const Outline& from, const Outline& to);

/// Points of a section's border (a mask whose pixels begin at `offset`) and of a picture's mask that belong together
/// [pixels]: in the same direction from their middles, which are the first pair, where both are stars; else by length.
std::vector<warp::Pin> boundary_pairs(const image::Grey& section, const Vec2& offset, const image::Grey& mask);

} // namespace kerf::texture
