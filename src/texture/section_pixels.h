#pragma once

/// Pixels over the body's section: those of an exemplar's plane, or others that the section alone decides, so that how
/// a picture is stored makes no difference to what is found on them.

#include "texture/slice.h"

namespace kerf::texture {

std::vector<Segment> in_pixels(const std::vector<Segment>& outline, const SectionPlane& plane);

/// Whole pixels around a section, with a margin.
struct PixelBox {
  Vec2 lower, upper;
  int width() const { return static_cast<int>(upper[0] - lower[0]) + 1; }
  int height() const { return static_cast<int>(upper[1] - lower[1]) + 1; }
};
PixelBox box_of(const std::vector<Segment>& outline, const SectionPlane& plane);

/// The same pixels, counted from another one.
SectionPlane moved(const SectionPlane& plane, const Vec2& first);

/// A point given in pixels of `from` [pixels of `plane`].
Vec2 pixels_of(const SectionPlane& plane, const SectionPlane& from, const Vec2& pixel);

/// Nearly square pixels of nearly the same area in the same plane, from the middle of an outline's box, rows along the
/// direction in which it is longest (as long all around: along an axis of the body's), seen from a side that the body's
/// axes decide. Those of a symmetric section are symmetric. `outline` in coordinates of the plane [m].
SectionPlane along_section(const std::vector<Segment>& outline, const SectionPlane& plane, const Mat3& body_axes);

/// A mask on other pixels of its plane, of which as many as cover it.
struct Relaid {
  image::Grey mask;
  SectionPlane plane; ///< of its pixels
};
Relaid relaid(const image::Grey& mask, const SectionPlane& plane, const SectionPlane& pixels);

} // namespace kerf::texture
