#include "gl/words.h"

#include "gl/context.h"
#include "gl/framebuffer.h"
#include "gl/mesh.h"
#include "gl/program.h"

#include <gtest/gtest.h>

#include <vector>

namespace kerf::gl::words_test {
namespace {

/// Writes the four bytes of the word at its pixel.
const ShaderText fragment = {
  "bytes.frag",
  "#version 330 core\n"
  "uniform usampler2D words;\n"
  "out vec4 colour;\n"
  "void main() {\n"
  "  uint word = texelFetch(words, ivec2(gl_FragCoord.xy), 0).r;\n"
  "  colour = vec4(word & 255u, (word >> 8) & 255u, (word >> 16) & 255u, word >> 24) / 255.0;\n"
  "}\n"};
const ShaderText screen = {
  "screen.vert",
  "#version 330 core\n"
  "void main() {\n"
  "  gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0);\n"
  "}\n"};
const ShaderText clipped = {"clipped.vert",
                            "#version 330 core\n"
                            "void main() {\n"
                            "  float x = gl_VertexID == 1 ? 3.0 : -1.0;\n"
                            "  gl_Position = vec4(x, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0);\n"
                            "  gl_ClipDistance[0] = x;\n"
                            "}\n"};
const ShaderText white = {"white.frag", "#version 330 core\nout vec4 c;\nvoid main() { c = vec4(1.0); }\n"};

TEST(Words, ReachTheShaderBitByBit) {
  const Context context;
  const Framebuffer image({.width = 3, .height = 2, .depth = Depth::none});
  const Words words(3, 2);
  const std::vector<std::uint32_t> sent = {0u, 1u, 0x80000000u, 0xffffffffu, 0x12345678u, 0x00ff00ffu};
  words.upload(sent);
  words.bind(0);
  const Program program(screen, fragment);
  program.set("words", 0);
  image.clear({0, 0, 0, 0});
  ScreenTriangle().draw();
  const auto bytes = image.read_rgba8();
  for (std::size_t i = 0; i < sent.size(); ++i) {
    const std::uint32_t read =
      bytes[4 * i] | bytes[4 * i + 1] << 8 | bytes[4 * i + 2] << 16 | std::uint32_t(bytes[4 * i + 3]) << 24;
    EXPECT_EQ(read, sent[i]) << i;
  }
}

TEST(Context, ClipsWhereADistanceIsNegative) {
  const Context context;
  const Framebuffer image({.width = 4, .height = 1, .depth = Depth::none});
  const Program program(clipped, white);
  context.clip(1);
  image.clear({0, 0, 0, 0});
  program.use();
  ScreenTriangle().draw();
  const auto pixels = image.read_rgba8();
  EXPECT_EQ(pixels[0], 0);
  EXPECT_EQ(pixels[12], 255);
}

} // namespace
} // namespace kerf::gl::words_test
