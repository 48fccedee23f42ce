#pragma once

/// An image and its PNG file.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace kerf::render {

/// sRGB pixels, 3 bytes each, rows from the top down.
struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb; ///< 3 * width * height

  std::array<std::uint8_t, 3> pixel(int column, int row) const {
    const auto* p = &rgb[3 * (static_cast<std::size_t>(row) * width + column)];
    return {p[0], p[1], p[2]};
  }
};

/// Writes an 8-bit RGB file; throws DataError with the path and the system's reason if not every byte was written.
void write_png(const Image& image, const std::string& path);

} // namespace kerf::render
