#include "image/filters.h"
#include "image/compare.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace kerf::image::filters_test {
namespace {

Grey wave(const int n, const double length) {
  Grey grey(n, n, 0);
  for (int r = 0; r < n; ++r)
    for (int c = 0; c < n; ++c)
      grey(c, r) = static_cast<float>(0.5 + 0.3 * std::sin(2 * M_PI * c / length));
  return grey;
}

Colours coloured(const Grey& grey) {
  Colours colours(grey.width, grey.height, Rgb::Zero());
  for (std::size_t i = 0; i < grey.values.size(); ++i)
    colours.values[i] = Rgb::Constant(grey.values[i]);
  return colours;
}

TEST(Sample, IsExactAtPixelsAndBetweenThemForPlanes) {
  Grey plane(9, 7, 0);
  for (int r = 0; r < 7; ++r)
    for (int c = 0; c < 9; ++c)
      plane(c, r) = static_cast<float>(2 * c - r);
  EXPECT_EQ(sample(plane, 8, 6), plane(8, 6));
  EXPECT_NEAR(sample(plane, 3.25f, 4.5f), 2 * 3.25 - 4.5, 1e-5);
  EXPECT_EQ(sample(plane, -5, 99), plane(0, 6));
}

TEST(Blur, KeepsConstantsAndDampsWavesAsTheFormulaSays) {
  const Grey flat(20, 20, 0.7f);
  for (const float value : blurred(flat, 2.5).values)
    EXPECT_NEAR(value, 0.7, 1e-5);
  const Grey in = wave(64, 16), out = blurred(in, 2);
  const double damping = std::exp(-0.5 * std::pow(2 * M_PI / 16 * 2, 2));
  for (int c = 16; c < 48; ++c)
    EXPECT_NEAR(out(c, 32) - 0.5, damping * (in(c, 32) - 0.5), 0.004);
}

TEST(Blur, NothingLeaksThroughAMask) {
  Grey in(20, 20, 0.2f), mask(20, 20, 1);
  for (int r = 0; r < 20; ++r)
    for (int c = 10; c < 20; ++c) {
      in(c, r) = 50;
      mask(c, r) = 0;
    }
  EXPECT_NEAR(blurred_inside(in, mask, 3)(9, 10), 0.2, 1e-5);
}

TEST(Stack, LevelsKeepTheSizePyramidsHalveIt) {
  const auto stack = gaussian_stack(coloured(wave(40, 8)), 4);
  ASSERT_EQ(stack.size(), 4u);
  EXPECT_EQ(stack[3].width, 40);
  const auto levels = pyramid(wave(40, 8), 9);
  EXPECT_EQ(levels[1].width, 20);
  EXPECT_GE(levels.back().width, 2);
}

TEST(Edges, OfAStepAreAsHighAsItsSlope) {
  Colours step(20, 20, Rgb::Zero());
  for (int r = 0; r < 20; ++r)
    for (int c = 10; c < 20; ++c)
      step(c, r) = Rgb(0, 0.6f, 0.8f);
  const Grey edges = edge_strength(step);
  EXPECT_NEAR(edges(10, 5), 0.5, 1e-5);
  EXPECT_NEAR(edges(9, 5), 0.5, 1e-5);
  EXPECT_NEAR(edges(5, 5), 0, 1e-6);
}

TEST(Filled, GoesOnSmoothly) {
  Colours half(64, 64, Rgb::Constant(9));
  Grey mask(64, 64, 0);
  for (int r = 0; r < 64; ++r)
    for (int c = 0; c < 20; ++c) {
      half(c, r) = Rgb::Constant(0.3f);
      mask(c, r) = 1;
    }
  for (const Rgb& value : filled(half, mask).values)
    EXPECT_NEAR(value[0], 0.3, 1e-4);
  for (const Rgb& value : filled(half, Grey(64, 64, 0)).values)
    EXPECT_EQ(value[0], 0);
}

TEST(Compare, KnownValues) {
  const Grey a = wave(64, 12), mask(64, 64, 1);
  Grey b = a;
  for (float& value : b.values)
    value += 0.1f;
  EXPECT_NEAR(psnr(coloured(a), coloured(b), mask), 20, 1e-3);
  EXPECT_EQ(psnr(coloured(a), coloured(a), mask), 200);
  EXPECT_NEAR(ssim(a, a, mask), 1, 1e-4);
  EXPECT_LT(ssim(a, wave(64, 7), mask), 0.5);
  const auto h = histogram(a, mask, 50), moved = histogram(b, mask, 50);
  EXPECT_NEAR(std::accumulate(h.begin(), h.end(), 0.0), 1, 1e-12);
  EXPECT_NEAR(histogram_distance(h, moved), 0.1, 0.005);
}

TEST(Compare, BandsFindTheirWavelength) {
  const Grey mask(128, 128, 1);
  const auto strongest = [&](const double length) {
    const auto power = band_power(wave(128, length), mask, 5);
    return std::max_element(power.begin(), power.end()) - power.begin();
  };
  EXPECT_EQ(strongest(4), 0);
  EXPECT_EQ(strongest(9), 1);
  EXPECT_EQ(strongest(18), 2);
}

} // namespace
} // namespace kerf::image::filters_test
