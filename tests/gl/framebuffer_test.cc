#include "gl/framebuffer.h"

#include "base/error.h"
#include "gl/context.h"
#include "gl/mesh.h"
#include "gl/program.h"

#include <gtest/gtest.h>

namespace kerf::gl::framebuffer_test {
namespace {

constexpr int size = 16;

const ShaderText vertex = {"coloured.vert",
                           "#version 330 core\n"
                           "layout(location = 0) in vec3 p;\n"
                           "layout(location = 1) in vec4 c;\n"
                           "out vec4 mixed;\n"
                           "void main() { mixed = c; gl_Position = vec4(p, 1.0); }\n"};
const ShaderText fragment = {"coloured.frag",
                             "#version 330 core\n"
                             "in vec4 mixed;\n"
                             "out vec4 colour;\n"
                             "void main() { colour = mixed; }\n"};

const ShaderText screen_vertex = {"screen.vert",
                                  "#version 330 core\n"
                                  "void main() { gl_Position = vec4(gl_VertexID == 1 ? 3 : -1,"
                                  " gl_VertexID == 2 ? 3 : -1, 0, 1); }\n"};
const ShaderText copy_fragment = {"copy.frag",
                                  "#version 330 core\n"
                                  "uniform sampler2D source, depths;\n"
                                  "out vec4 colour;\n"
                                  "void main() { ivec2 p = ivec2(gl_FragCoord.xy);"
                                  " colour = vec4(texelFetch(source, p, 0).rg,"
                                  " texelFetch(depths, p, 0).r, 1); }\n"};

/// From pixel to clip coordinates: pixel (i, j) has its centre at i + 1/2, j + 1/2.
float clip(float pixel) { return 2 * pixel / size - 1; }

/// One triangle, corners in pixels, at clip depth z, of one colour.
void add_triangle(std::vector<float>& vertices, const float (&corners)[3][2], float z, const Eigen::Vector4f& c) {
  for (const auto& [x, y] : corners)
    vertices.insert(vertices.end(), {clip(x), clip(y), z, c[0], c[1], c[2], c[3]});
}

TEST(Framebuffer, ReadsBackExactColours) {
  const Context context;
  const Framebuffer bytes({.width = 3, .height = 2});
  bytes.clear({17 / 255.0f, 128 / 255.0f, 1, 0});
  const std::vector<std::uint8_t> rgba8 = bytes.read_rgba8();
  ASSERT_EQ(rgba8.size(), 24u);
  for (std::size_t i = 0; i < rgba8.size(); i += 4)
    EXPECT_EQ(std::vector(rgba8.begin() + i, rgba8.begin() + i + 4), (std::vector<std::uint8_t>{17, 128, 255, 0}));

  const Framebuffer floats({.width = 3, .height = 2, .colour = Colour::rgba32f, .depth = Depth::none});
  floats.clear({-0.1f, 1e-20f, 12345.678f, 2});
  const std::vector<float> rgba32f = floats.read_rgba32f();
  for (std::size_t i = 0; i < rgba32f.size(); i += 4)
    EXPECT_EQ(std::vector(rgba32f.begin() + i, rgba32f.begin() + i + 4),
              (std::vector<float>{-0.1f, 1e-20f, 12345.678f, 2}));
}

TEST(Mesh, ATriangleCoversThePixelsWhoseCentresItHolds) {
  const Context context;
  const Framebuffer image({.width = size, .height = size});
  const Program program(vertex, fragment);
  Mesh mesh{3, 4};
  std::vector<float> vertices;
  add_triangle(vertices, {{2, 3}, {13, 3}, {2, 14}}, 0, {1, 0, 0, 1});
  mesh.upload(vertices, std::vector<std::uint32_t>{0, 1, 2});
  image.clear(Eigen::Vector4f::Zero());
  program.use();
  mesh.draw();
  const auto rgba = image.read_rgba8();
  for (int j = 0; j < size; ++j)
    for (int i = 0; i < size; ++i) {
      const float slack = 16 - (i + 0.5f) - (j + 0.5f); // the slanted side is x + y = 16
      if (slack == 0)
        continue; // on the side: either is right
      const bool inside = i >= 2 && j >= 3 && slack > 0;
      EXPECT_EQ(rgba[4 * (size * j + i)], inside ? 255 : 0) << i << ", " << j;
    }
}

TEST(Mesh, TheNearerTriangleHidesTheFartherOne) {
  const Context context;
  const Framebuffer image({.width = size, .height = size});
  const Program program(vertex, fragment);
  Mesh mesh{3, 4};
  std::vector<float> vertices;
  add_triangle(vertices, {{0, 0}, {32, 0}, {0, 32}}, -0.5f, {0, 1, 0, 1});
  add_triangle(vertices, {{0, 0}, {32, 0}, {0, 32}}, 0.5f, {1, 0, 0, 1});
  mesh.upload(vertices, std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5});
  image.clear(Eigen::Vector4f::Zero());
  program.use();
  mesh.draw();
  const auto rgba = image.read_rgba8();
  EXPECT_EQ(rgba[0], 0);
  EXPECT_EQ(rgba[1], 255);
  for (const float depth : image.read_depth())
    EXPECT_FLOAT_EQ(depth, 0.25f);
}

TEST(Mesh, ATextureOfAnEarlierPassIsReadByTheNext) {
  const Context context;
  const Framebuffer first({.width = size, .height = size, .colour = Colour::rgba16f});
  const Framebuffer second({.width = size, .height = size});
  const Program copy(screen_vertex, copy_fragment);
  const ScreenTriangle screen;
  first.clear({0.25f, 0.5f, 0, 1});
  second.clear(Eigen::Vector4f::Zero());
  first.bind_colour(0);
  first.bind_depth(1);
  copy.set("source", 0);
  copy.set("depths", 1);
  screen.draw();
  const auto rgba = second.read_rgba8();
  for (std::size_t i = 0; i < rgba.size(); i += 4) {
    EXPECT_EQ(rgba[i], 64);
    EXPECT_EQ(rgba[i + 1], 128);
    EXPECT_EQ(rgba[i + 2], 255);
  }
}

TEST(Framebuffer, RefusesSizesThatOpenGLCannotHold) {
  const Context context;
  EXPECT_THROW(Framebuffer({.width = 0, .height = 4}), ParameterError);
  EXPECT_THROW(Framebuffer({.width = 4, .height = 1 << 20}), ParameterError);
}

} // namespace
} // namespace kerf::gl::framebuffer_test
