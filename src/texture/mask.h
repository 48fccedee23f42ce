#pragma once

/// Which pixels of a picture show the section.

#include "image/image.h"

namespace kerf::texture {

enum class Background {
  alpha, ///< what is transparent; nothing where the picture has no alpha
  black, ///< what is nearly black and connected to the border by such pixels: dark places inside are section
  none   ///< the whole picture is section
};

/// 1 section, 0 background. Throws ParameterError about the key "Image" if the picture is smaller than 8 x 8 pixels or
/// no pixel is section.
image::Grey mask_of(const image::Image& picture, Background background);

/// How far the pixels of a mask reach from a centre along a unit direction [pixels].
double reach(const image::Grey& mask, const Vec2& centre, const Vec2& along);

/// The largest 8-connected set of pixels above a half.
image::Grey largest_component(const image::Grey& mask);

/// Numbers the 8-connected sets of pixels above a half from 1, by size; 0 elsewhere. Sets smaller than `least` pixels
/// count as elsewhere.
image::Raster<int> components(const image::Grey& mask, std::size_t least, int& n_components);

} // namespace kerf::texture
