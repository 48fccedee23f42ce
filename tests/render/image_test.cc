#include "render/image.h"

#include "base/error.h"

#include <gtest/gtest.h>
#include <png.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <random>

namespace kerf::render::image_test {
namespace {

Image noise(int width, int height) {
  std::mt19937 random(7);
  Image image{width, height, {}};
  for (int i = 0; i < 3 * width * height; ++i)
    image.rgb.push_back(static_cast<std::uint8_t>(random() & 255));
  return image;
}

std::string message_of_writing(const Image& image, const std::string& path) {
  try {
    write_png(image, path);
  } catch (const DataError& e) {
    return e.what();
  }
  return "nothing was thrown";
}

bool holds(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(Image, AFileHoldsThePixels) {
  const auto path = std::filesystem::temp_directory_path() / "kerf_test_image.png";
  const Image image = noise(37, 23);
  write_png(image, path);
  png_image header = {};
  header.version = PNG_IMAGE_VERSION;
  ASSERT_TRUE(png_image_begin_read_from_file(&header, path.c_str())) << header.message;
  EXPECT_EQ(header.width, 37u);
  EXPECT_EQ(header.height, 23u);
  EXPECT_EQ(header.format, static_cast<png_uint_32>(PNG_FORMAT_RGB));
  std::vector<std::uint8_t> rgb(PNG_IMAGE_SIZE(header));
  ASSERT_TRUE(png_image_finish_read(&header, nullptr, rgb.data(), 0, nullptr)) << header.message;
  EXPECT_EQ(rgb, image.rgb);
  std::filesystem::remove(path);
}

TEST(Image, SaysWhichPathCannotBeWritten) {
  const std::string path = "/no/such/folder/image.png";
  const std::string message = message_of_writing(noise(2, 2), path);
  EXPECT_TRUE(holds(message, path)) << message;
  EXPECT_TRUE(holds(message, std::strerror(ENOENT))) << message;
}

TEST(Image, NoticesAFullDisk) {
  // The small file is refused when it is flushed, the large one when it is written.
  for (const int size : {4, 300}) {
    const std::string message = message_of_writing(noise(size, size), "/dev/full");
    EXPECT_TRUE(holds(message, "/dev/full")) << message;
    EXPECT_TRUE(holds(message, std::strerror(ENOSPC))) << message;
  }
}

TEST(Image, RefusesPixelsThatDoNotFit) {
  EXPECT_THROW(write_png(Image{2, 2, {1, 2, 3}}, "/dev/null"), DataError);
  EXPECT_THROW(write_png(Image{}, "/dev/null"), DataError);
}

} // namespace
} // namespace kerf::render::image_test
