// Splines through pixels: exact there, exact on parabolas, and closer to a fine wave than straight lines.

#include "image/spline.h"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::image::spline_test {
namespace {

template <class Function>
Colours colours_of(const int width, const int height, const Function& f) {
  Colours colours(width, height, Rgb::Zero());
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c)
      colours(c, r) = f(static_cast<float>(c), static_cast<float>(r));
  return colours;
}

TEST(Spline, GoesThroughThePixels) {
  for (const auto& [width, height] : {std::pair(2, 2), std::pair(3, 2), std::pair(40, 29)}) {
    const Colours colours = colours_of(width, height, [](const float x, const float y) {
      return Rgb(std::sin(3 * x + y * y), x > y ? 1 : 0, std::cos(x * y));
    });
    const Colours spline = spline_coefficients(colours);
    for (int r = 0; r < height; ++r)
      for (int c = 0; c < width; ++c)
        EXPECT_LT((sample_spline(spline, float(c), float(r)) - colours(c, r)).abs().maxCoeff(), 2e-6f) << c << " " << r;
  }
}

TEST(Spline, ReproducesParabolasAwayFromTheBorder) {
  const auto f = [](const float x, const float y) {
    return Rgb(0.1f * x, 0.01f * x * x - 0.02f * x * y, 0.01f * y * y + 1);
  };
  const Colours spline = spline_coefficients(colours_of(40, 40, f));
  for (float x = 15; x < 25; x += 0.3f)
    for (float y = 15; y < 25; y += 0.7f)
      EXPECT_LT((sample_spline(spline, x, y) - f(x, y)).abs().maxCoeff(), 1e-4f) << x << " " << y;
}

TEST(Spline, KeepsMoreOfAFineWave) {
  const auto f = [](const float x, const float) { return Rgb(Rgb::Constant(std::sin(2.0f * x))); }; // 3.1 pixels
  const Colours colours = colours_of(60, 4, f), spline = spline_coefficients(colours);
  float of_spline = 0, of_lines = 0;
  for (float x = 15; x < 45; x += 0.1f) {
    of_spline = std::max(of_spline, (sample_spline(spline, x, 1) - f(x, 1)).abs().maxCoeff());
    of_lines = std::max(of_lines, (sample(colours, x, 1) - f(x, 1)).abs().maxCoeff());
  }
  std::printf("a wave of 3.1 pixels: largest error of the spline %.3f, of straight lines %.3f\n", of_spline, of_lines);
  EXPECT_LT(of_spline, 0.3f * of_lines);
}

TEST(Spline, IsContinuous) {
  const Colours spline = spline_coefficients(
    colours_of(12, 12, [](const float x, const float y) { return Rgb(Rgb::Constant(std::sin(5 * x + 3 * y))); }));
  for (float x = 0; x < 12; x += 0.5f)
    for (float y = 0; y < 12; ++y)
      EXPECT_LT((sample_spline(spline, x - 1e-5f, y) - sample_spline(spline, x + 1e-5f, y)).abs().maxCoeff(), 1e-3f);
}

} // namespace
} // namespace kerf::image::spline_test
