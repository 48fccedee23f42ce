#pragma once

/// Pictures from and to files: PNG by libpng, JPEG by libjpeg.

#include "image/image.h"

#include <string>

namespace kerf::image {

/// Reads a PNG (grey or colour, with or without alpha or palette, 1 to 16 bits; 16 are rounded to 8) or a JPEG (grey or
/// colour) by what the file holds, not by its name. Throws DataError: missing, of another kind, damaged.
Image read_image(const std::string& path);

/// Writes 8-bit colours, values cut to [0, 1], as PNG or JPEG by the name's end (.png, .jpg, .jpeg); alpha goes into a
/// PNG only. Throws DataError if the name ends otherwise, or with the system's reason if not every byte was written.
void write_image(const Image& image, const std::string& path);
void write_image(const Colours& colours, const std::string& path);

} // namespace kerf::image
