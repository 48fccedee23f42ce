#include "base/error.h"
#include "image/formats.h"

#include <png.h>

#include <algorithm>
#include <array>

namespace kerf::image {

namespace {

constexpr std::array<std::uint8_t, 8> signature = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
constexpr std::size_t bit_depth_at = 24; // of the header chunk, which comes first

/// libpng's simplified interface holds memory until it has read all, or is told to let go.
struct Reading {
  png_image header = {};
  ~Reading() { png_image_free(&header); }
};

Image from_rgba(const png_image& header, const Bytes& rgba) {
  const int width = static_cast<int>(header.width), height = static_cast<int>(header.height);
  Image image{Colours(width, height, Rgb::Zero()), {}};
  for (std::size_t i = 0; i < image.colours.values.size(); ++i)
    image.colours.values[i] = Rgb(rgba[4 * i], rgba[4 * i + 1], rgba[4 * i + 2]) / 255.0f;
  return image;
}

} // namespace

bool is_png(const Bytes& bytes) {
  return bytes.size() > bit_depth_at && std::equal(signature.begin(), signature.end(), bytes.begin());
}

Image decode_png(const Bytes& bytes) {
  Reading reading;
  png_image& header = reading.header;
  header.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_memory(&header, bytes.data(), bytes.size()))
    throw DataError(header.message);
  const bool has_alpha = (header.format & PNG_FORMAT_FLAG_ALPHA) != 0;
  const bool has_colour = (header.format & PNG_FORMAT_FLAG_COLOR) != 0;
  header.flags |= PNG_IMAGE_FLAG_16BIT_sRGB; // 16 bits without a word on their meaning are like 8
  header.format = PNG_FORMAT_RGBA;
  Bytes rgba(PNG_IMAGE_SIZE(header));
  if (!png_image_finish_read(&header, nullptr, rgba.data(), 0, nullptr))
    throw DataError(header.message);
  Image image = from_rgba(header, rgba);
  image.bits = bytes[bit_depth_at];
  image.n_channels = has_colour ? 3 : 1;
  if (has_alpha) {
    image.alpha = Grey(image.width(), image.height(), 1);
    for (std::size_t i = 0; i < image.alpha.values.size(); ++i)
      image.alpha.values[i] = static_cast<float>(rgba[4 * i + 3]) / 255.0f;
  }
  return image;
}

Bytes encode_png(const Image& image) {
  png_image header = {};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.width());
  header.height = static_cast<png_uint_32>(image.height());
  header.format = image.has_alpha() ? PNG_FORMAT_RGBA : PNG_FORMAT_RGB;
  Bytes pixels;
  for (std::size_t i = 0; i < image.colours.values.size(); ++i) {
    for (int k = 0; k < 3; ++k)
      pixels.push_back(to_byte(image.colours.values[i][k]));
    if (image.has_alpha())
      pixels.push_back(to_byte(image.alpha.values[i]));
  }
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(header);
  Bytes bytes(size);
  if (!png_image_write_to_memory(&header, bytes.data(), &size, 0, pixels.data(), 0, nullptr))
    throw DataError(header.message);
  bytes.resize(size);
  return bytes;
}

} // namespace kerf::image
