#include "render/image.h"

#include "base/error.h"

#include <png.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>

namespace kerf::render {

namespace {

DataError failure(const std::string& path, const std::string& rule) {
  return DataError({.path = "image file",
                    .value = path,
                    .rule = rule,
                    .remedy = "Check that the folder exists, may be written and has room"});
}

/// Says of the file that it is Kerf's: a chunk of text, with its length before and its checksum (CRC-32) behind it.
/// output/results_folder.cc knows our pictures by it.
constexpr std::array<unsigned char, 25> mark = {0,   0,   0,   13, 't', 'E', 'X', 't', 'S',  'o',  'f',  't', 'w',
                                                'a', 'r', 'e', 0,  'K', 'e', 'r', 'f', 0x81, 0x7e, 0xae, 0x65};
constexpr std::ptrdiff_t after_header = 33; // signature and first chunk of every PNG file

/// The whole file in memory: then a failed write cannot be mistaken for a failed compression.
std::vector<unsigned char> encode(const Image& image, const std::string& path) {
  png_image header = {};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.width);
  header.height = static_cast<png_uint_32>(image.height);
  header.format = PNG_FORMAT_RGB;
  header.flags = PNG_IMAGE_FLAG_FAST; // 8 ms an image instead of 38, for files a third larger
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(header);
  std::vector<unsigned char> bytes(size);
  if (!png_image_write_to_memory(&header, bytes.data(), &size, 0, image.rgb.data(), 0, nullptr))
    throw failure(path, std::string("libpng cannot encode the image: ") + header.message);
  bytes.resize(size);
  bytes.insert(bytes.begin() + after_header, mark.begin(), mark.end());
  return bytes;
}

} // namespace

void write_png(const Image& image, const std::string& path) {
  const auto n_bytes = 3 * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  if (image.width < 1 || image.height < 1 || image.rgb.size() != n_bytes)
    throw failure(path, "an image needs 3 bytes a pixel and at least one pixel");
  const auto bytes = encode(image, path);
  std::FILE* const file = std::fopen(path.c_str(), "wb");
  if (!file)
    throw failure(path, std::string("cannot be opened: ") + std::strerror(errno));
  // A full disk may show only when the buffers are flushed, or when the file is closed.
  const bool written = std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size() && std::fflush(file) == 0;
  const int reason = errno;
  const bool closed = std::fclose(file) == 0;
  if (!written || !closed)
    throw failure(path, std::string("cannot be written: ") + std::strerror(written ? errno : reason));
}

} // namespace kerf::render
