#include "image/file.h"

#include "base/error.h"
#include "image/formats.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace kerf::image {

namespace {

DataError unreadable(const std::string& path, const std::string& rule, const std::string& remedy) {
  return DataError({.path = "image file", .value = path, .rule = rule, .remedy = remedy});
}

DataError unwritable(const std::string& path, const std::string& rule) {
  return DataError({.path = "image file",
                    .value = path,
                    .rule = rule,
                    .remedy = "Check that the folder exists, may be written and has room"});
}

Bytes read_bytes(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored))
    throw unreadable(path, "is a folder, not a picture", "Name a PNG or JPEG file in it");
  if (!std::filesystem::is_regular_file(path, ignored))
    throw unreadable(path, "there is no such file", "Check the name; relative paths start at the scene file");
  std::ifstream in(path, std::ios::binary);
  if (!in)
    throw unreadable(path, std::string("cannot be opened: ") + std::strerror(errno), "Change its permissions");
  return Bytes(std::istreambuf_iterator<char>(in), {});
}

/// A full disk may show only when the buffers are flushed, or when the file is closed.
void write_bytes(const Bytes& bytes, const std::string& path) {
  std::FILE* const file = std::fopen(path.c_str(), "wb");
  if (!file)
    throw unwritable(path, std::string("cannot be opened: ") + std::strerror(errno));
  const bool written = std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size() && std::fflush(file) == 0;
  const int reason = errno;
  const bool closed = std::fclose(file) == 0;
  if (!written || !closed)
    throw unwritable(path, std::string("cannot be written: ") + std::strerror(written ? errno : reason));
}

} // namespace

Image read_image(const std::string& path) {
  const Bytes bytes = read_bytes(path);
  try {
    if (is_png(bytes))
      return decode_png(bytes);
    if (is_jpeg(bytes))
      return decode_jpeg(bytes);
  } catch (const DataError& error) {
    throw unreadable(path, std::string("is damaged, or of a kind that is not read: ") + error.what(),
                     "Write it anew from its source, as RGB or grey");
  }
  throw unreadable(path, "is neither a PNG nor a JPEG", "Convert it to one of these");
}

void write_image(const Image& image, const std::string& path) {
  const std::string end = std::filesystem::path(path).extension().string();
  if (image.width() < 1 || image.height() < 1)
    throw unwritable(path, "an image needs at least one pixel");
  if (end == ".png")
    write_bytes(encode_png(image), path);
  else if (end == ".jpg" || end == ".jpeg")
    write_bytes(encode_jpeg(image), path);
  else
    throw DataError({.path = "image file",
                     .value = path,
                     .rule = "must end in .png, .jpg or .jpeg",
                     .remedy = "Choose one of these names"});
}

void write_image(const Colours& colours, const std::string& path) { write_image(Image{colours, {}}, path); }

} // namespace kerf::image
