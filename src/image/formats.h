#pragma once

/// The two file formats, from and to bytes. What a library says of damaged bytes is thrown as DataError without a path.

#include "image/image.h"

#include <cstdint>

namespace kerf::image {

using Bytes = std::vector<std::uint8_t>;

bool is_png(const Bytes& bytes);
bool is_jpeg(const Bytes& bytes);
Image decode_png(const Bytes& bytes);
Image decode_jpeg(const Bytes& bytes);
Bytes encode_png(const Image& image);
Bytes encode_jpeg(const Image& image);

/// 8 bits of a value in [0, 1].
inline std::uint8_t to_byte(const float value) {
  return static_cast<std::uint8_t>(std::min(std::max(value, 0.0f), 1.0f) * 255.0f + 0.5f);
}

} // namespace kerf::image
