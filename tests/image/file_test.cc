#include "image/file.h"

#include "base/error.h"
#include "tests/output/samples.h"

#include <gtest/gtest.h>
#include <png.h>

#include <cstdio>
#include <fstream>

#include <jpeglib.h>

namespace kerf::image::file_test {
namespace {

Image ramp(const int width, const int height) {
  Image image{Colours(width, height, Rgb::Zero()), {}};
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c)
      image.colours(c, r) = Rgb(float(c) / float(width), float(r) / float(height), 0.25f);
  return image;
}

float largest_difference(const Image& a, const Image& b) {
  float largest = 0;
  for (std::size_t i = 0; i < a.colours.values.size(); ++i)
    largest = std::max(largest, (a.colours.values[i] - b.colours.values[i]).abs().maxCoeff());
  return largest;
}

/// Writes a file by libpng directly, in a format that write_image has not.
void write_raw(const std::string& path, const int format, const void* pixels) {
  png_image header = {};
  header.version = PNG_IMAGE_VERSION;
  header.width = header.height = 8;
  header.format = format;
  ASSERT_TRUE(png_image_write_to_file(&header, path.c_str(), 0, pixels, 0, nullptr)) << header.message;
}

void expect_refused(const std::string& path, const std::string& part) {
  try {
    read_image(path);
    FAIL() << path;
  } catch (const DataError& error) {
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find(path), std::string::npos) << error.what();
  }
}

TEST(ImageFile, PngComesBackWithAlpha) {
  const output::TemporaryFolder folder;
  Image image = ramp(33, 17);
  image.alpha = Grey(33, 17, 1);
  image.alpha(3, 4) = 0;
  write_image(image, (folder / "a.png").string());
  const Image back = read_image((folder / "a.png").string());
  EXPECT_LT(largest_difference(image, back), 0.6f / 255);
  ASSERT_TRUE(back.has_alpha());
  EXPECT_EQ(back.alpha(3, 4), 0);
  EXPECT_EQ(back.alpha(4, 3), 1);
}

TEST(ImageFile, JpegComesBackNearly) {
  const output::TemporaryFolder folder;
  const Image image = ramp(64, 48);
  write_image(image, (folder / "a.jpg").string());
  const Image back = read_image((folder / "a.jpg").string());
  EXPECT_EQ(back.width(), 64);
  EXPECT_EQ(back.height(), 48);
  EXPECT_FALSE(back.has_alpha());
  EXPECT_LT(largest_difference(image, back), 0.04f);
}

TEST(ImageFile, GreyAnd16BitsAreRead) {
  const output::TemporaryFolder folder;
  std::vector<std::uint8_t> grey(64);
  std::vector<std::uint16_t> wide(64);
  for (int i = 0; i < 64; ++i) {
    grey[i] = static_cast<std::uint8_t>(4 * i);
    wide[i] = static_cast<std::uint16_t>(1000 * i);
  }
  write_raw((folder / "grey.png").string(), PNG_FORMAT_GRAY, grey.data());
  const Image one = read_image((folder / "grey.png").string());
  EXPECT_EQ(one.n_channels, 1);
  EXPECT_NEAR(one.colours(3, 2)[1], 4 * 19 / 255.0, 1e-6);
  write_raw((folder / "wide.png").string(), PNG_FORMAT_LINEAR_Y, wide.data());
  const Image two = read_image((folder / "wide.png").string());
  EXPECT_EQ(two.bits, 16);
  EXPECT_EQ(two.n_channels, 1);
  for (int i = 1; i < 64; ++i)
    EXPECT_GE(two.colours.values[i][0], two.colours.values[i - 1][0]);
  EXPECT_GT(two.colours.values[63][0], 0.9f);
}

/// Writes a JPEG of four channels by libjpeg directly.
void write_cmyk(const std::string& path) {
  jpeg_compress_struct context = {};
  jpeg_error_mgr manager = {};
  context.err = jpeg_std_error(&manager);
  jpeg_create_compress(&context);
  std::FILE* const file = std::fopen(path.c_str(), "wb");
  jpeg_stdio_dest(&context, file);
  context.image_width = context.image_height = 8;
  context.input_components = 4;
  context.in_color_space = JCS_CMYK;
  jpeg_set_defaults(&context);
  jpeg_start_compress(&context, TRUE);
  std::vector<JSAMPLE> row(32, 100);
  JSAMPROW place = row.data();
  for (int r = 0; r < 8; ++r)
    jpeg_write_scanlines(&context, &place, 1);
  jpeg_finish_compress(&context);
  jpeg_destroy_compress(&context);
  std::fclose(file);
}

TEST(ImageFile, BadFilesAreRefused) {
  const output::TemporaryFolder folder;
  expect_refused((folder / "none.png").string(), "no such file");
  std::ofstream(folder / "text.png") << "this is no picture, although its name says so";
  expect_refused((folder / "text.png").string(), "neither a PNG nor a JPEG");
  write_cmyk((folder / "press.jpg").string());
  expect_refused((folder / "press.jpg").string(), "CMYK");
  expect_refused((folder / "press.jpg").string(), "as RGB or grey");
  write_image(ramp(64, 64), (folder / "a.png").string());
  write_image(ramp(64, 64), (folder / "a.jpg").string());
  for (const std::string name : {"a.png", "a.jpg"}) {
    std::filesystem::resize_file(folder / name, std::filesystem::file_size(folder / name) / 2);
    expect_refused((folder / name).string(), "is damaged");
  }
  EXPECT_THROW(write_image(ramp(4, 4), (folder / "a.bmp").string()), DataError);
  EXPECT_THROW(write_image(ramp(4, 4), (folder / "no" / "a.png").string()), DataError);
}

} // namespace
} // namespace kerf::image::file_test
