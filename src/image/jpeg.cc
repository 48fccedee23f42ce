#include "base/error.h"
#include "image/formats.h"

#include <cstdio>

#include <jpeglib.h>

#include <array>
#include <csetjmp>
#include <cstdlib>

namespace kerf::image {

namespace {

/// libjpeg ends the process on an error unless its handler jumps away. Nothing with a destructor may live in a function
/// that is jumped out of.
struct Escape {
  jpeg_error_mgr manager = {};
  std::jmp_buf place = {};
  std::array<char, JMSG_LENGTH_MAX> message = {};
};

extern "C" void leave(j_common_ptr context) {
  auto* const escape = reinterpret_cast<Escape*>(context->err);
  (*context->err->format_message)(context, escape->message.data());
  std::longjmp(escape->place, 1);
}
extern "C" void say_nothing(j_common_ptr) {}

jpeg_error_mgr* prepare(Escape& escape) {
  jpeg_error_mgr* const manager = jpeg_std_error(&escape.manager);
  manager->error_exit = leave;
  manager->output_message = say_nothing;
  return manager;
}

constexpr int n_of_cmyk = 4; ///< channels

/// Rows as they come; false with the message in `escape` when the bytes are damaged.
bool decompress(const Bytes& bytes, jpeg_decompress_struct& context, Escape& escape, Bytes& rgb) {
  context.err = prepare(escape);
  if (setjmp(escape.place) != 0)
    return false;
  jpeg_create_decompress(&context);
  jpeg_mem_src(&context, bytes.data(), bytes.size());
  jpeg_read_header(&context, TRUE);
  if (context.num_components == n_of_cmyk)
    return false;
  context.out_color_space = JCS_RGB;
  jpeg_start_decompress(&context);
  const std::size_t row = std::size_t{3} * context.output_width;
  rgb.resize(row * context.output_height);
  while (context.output_scanline < context.output_height) {
    JSAMPROW place = rgb.data() + row * context.output_scanline;
    jpeg_read_scanlines(&context, &place, 1);
  }
  jpeg_finish_decompress(&context);
  return escape.manager.num_warnings == 0; // such as an early end, which libjpeg fills with grey
}

bool compress(const Bytes& rgb, const int width, const int height, jpeg_compress_struct& context, Escape& escape,
              unsigned char*& result, unsigned long& size) {
  context.err = prepare(escape);
  if (setjmp(escape.place) != 0)
    return false;
  jpeg_create_compress(&context);
  jpeg_mem_dest(&context, &result, &size);
  context.image_width = static_cast<JDIMENSION>(width);
  context.image_height = static_cast<JDIMENSION>(height);
  context.input_components = 3;
  context.in_color_space = JCS_RGB;
  jpeg_set_defaults(&context);
  jpeg_set_quality(&context, 95, TRUE);
  jpeg_start_compress(&context, TRUE);
  while (context.next_scanline < context.image_height) {
    auto* place = const_cast<JSAMPROW>(rgb.data() + std::size_t{3} * context.image_width * context.next_scanline);
    jpeg_write_scanlines(&context, &place, 1);
  }
  jpeg_finish_compress(&context);
  return true;
}

} // namespace

bool is_jpeg(const Bytes& bytes) {
  return bytes.size() > 3 && bytes[0] == 0xff && bytes[1] == 0xd8 && bytes[2] == 0xff;
}

Image decode_jpeg(const Bytes& bytes) {
  jpeg_decompress_struct context = {};
  Escape escape;
  Bytes rgb;
  const bool done = decompress(bytes, context, escape, rgb);
  const int width = static_cast<int>(context.output_width), height = static_cast<int>(context.output_height);
  const int n_in_file = context.num_components;
  jpeg_destroy_decompress(&context);
  if (n_in_file == n_of_cmyk)
    throw DataError("it has the four channels of a printing press (CMYK)");
  if (!done)
    throw DataError(escape.message[0] != 0 ? escape.message.data() : "the file ends early or is damaged");
  Image image{Colours(width, height, Rgb::Zero()), {}};
  image.n_channels = n_in_file == 1 ? 1 : 3;
  for (std::size_t i = 0; i < image.colours.values.size(); ++i)
    image.colours.values[i] = Rgb(rgb[3 * i], rgb[3 * i + 1], rgb[3 * i + 2]) / 255.0f;
  return image;
}

Bytes encode_jpeg(const Image& image) {
  Bytes rgb;
  for (const Rgb& colour : image.colours.values)
    for (int k = 0; k < 3; ++k)
      rgb.push_back(to_byte(colour[k]));
  jpeg_compress_struct context = {};
  Escape escape;
  unsigned char* result = nullptr;
  unsigned long size = 0;
  const bool done = compress(rgb, image.width(), image.height(), context, escape, result, size);
  jpeg_destroy_compress(&context);
  const Bytes bytes = done ? Bytes(result, result + size) : Bytes();
  std::free(result);
  if (!done)
    throw DataError(escape.message.data());
  return bytes;
}

} // namespace kerf::image
