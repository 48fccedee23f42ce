#include "base/error.h"
#include "render/renderer.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace kerf::render::samples_test {
namespace {

/// One triangle, seen from above, whose samples are red at its first corner's end and green at the others.
struct Sampled {
  Points positions = {{-1, -1, 0}, {1, -1, 0}, {-1, 1, 0}};
  std::vector<Triangle> triangles = {{0, 1, 2}};
  std::vector<std::uint16_t> labels = {1};
  std::vector<std::uint32_t> first = {0};
  std::vector<std::uint16_t> parts = {8};
  std::vector<std::array<std::uint8_t, 3>> colours;
  std::vector<std::array<float, 2>> slopes;

  Sampled() {
    for (int i = 0; i <= 8; ++i)
      for (int j = 0; i + j <= 8; ++j)
        colours.push_back(i < 4 ? std::array<std::uint8_t, 3>{200, 20, 20} : std::array<std::uint8_t, 3>{20, 200, 20});
  }

  Image draw() const {
    const Camera camera{.eye = {0, 0, 5}, .up = {0, 1, 0}, .field_of_view = 30, .width = 80, .height = 80};
    return Renderer(camera, {}).draw({{{positions, triangles, labels, {first, parts, colours, slopes}}}, {}, {}});
  }
};

TEST(Samples, AreTheColoursOfTheTriangle) {
  const Image image = Sampled().draw();
  const auto red = image.pixel(24, 50), green = image.pixel(48, 58);
  EXPECT_GT(red[0], 2 * red[1]);
  EXPECT_GT(green[1], 2 * green[0]);
}

TEST(Samples, SlopesBendTheNormals) {
  Sampled flat, bent;
  bent.slopes.assign(bent.colours.size(), {1.5f, 0});
  const auto a = flat.draw().pixel(24, 50), b = bent.draw().pixel(24, 50);
  EXPECT_GT(std::abs(a[0] - b[0]), 8);
}

TEST(Samples, MustFitTheTriangles) {
  Sampled few;
  few.colours.pop_back();
  EXPECT_THROW(few.draw(), DataError);
  Sampled many;
  many.parts.push_back(8);
  EXPECT_THROW(many.draw(), DataError);
}

} // namespace
} // namespace kerf::render::samples_test
