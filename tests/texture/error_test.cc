// Error and sharpness against solids whose colour is known everywhere, as bench_texture_error prints them in full.

#include "image/compare.h"
#include "tests/texture/probes.h"

#include <gtest/gtest.h>

namespace kerf::texture::error_test {
namespace {

struct Known {
  const char* name;
  Solid solid;
  int n_sections;
  double height; ///< of the painted plane [m]
  double gain;   ///< of warps over the blend, least [dB]
};
void PrintTo(const Known& known, std::ostream* out) { *out << known.name; }

class Error : public testing::TestWithParam<Known> {};

TEST_P(Error, WarpsGainAndKeepWhatIsSharp) {
  constexpr int n = 160;
  const int n_sections = GetParam().n_sections;
  std::vector<Exemplar> exemplars;
  for (int i = 0; i < n_sections; ++i)
    exemplars.push_back(exemplar_of("e" + std::to_string(i), GetParam().solid,
                                    Vec3(0, 0, 0.03 * (2.0 * i / (n_sections - 1) - 1)), Vec3::UnitX(), Vec3::UnitY()));
  const Interior inside(exemplars, ball(4), {});
  const double pixel = 0.104 / (n - 1);
  const Patch patch{Vec3(-0.052, -0.052, GetParam().height), pixel * Vec3::UnitX(), pixel * Vec3::UnitY(), n, n};
  image::Colours truth(n, n, image::Rgb::Zero());
  image::Grey mask(n, n, 0);
  for (int r = 0; r < n; ++r)
    for (int c = 0; c < n; ++c) {
      truth(c, r) = GetParam().solid(patch.point(c, r));
      mask(c, r) = patch.point(c, r).norm() < 0.0495 ? 1.0f : 0.0f;
    }
  const auto blend = colours_of(paint(inside, patch, nullptr, {.morph = Morph::blend}));
  const auto warped = colours_of(paint(inside, patch, nullptr, {}));
  const double gain = image::psnr(warped, truth, mask) - image::psnr(blend, truth, mask);
  const auto power = image::band_power(image::luminance(warped), mask, 2);
  const auto of_truth = image::band_power(image::luminance(truth), mask, 2);
  std::printf("%s: warps gain %.1f dB; power of the two finest octaves over the truth's %.2f, %.2f\n", GetParam().name,
              gain, power[0] / of_truth[0], power[1] / of_truth[1]);
  EXPECT_GT(gain, GetParam().gain);
  EXPECT_NEAR(power[1] / of_truth[1], 1, 0.15);
  EXPECT_GT(power[0] / of_truth[0], 0.8);
}

// Between the seven sections rings shift by more than half of their distance, once boxes match.
INSTANTIATE_TEST_SUITE_P(Solids, Error,
                         testing::Values(Known{"wood", wood, 9, 0.0041, 5}, Known{"wood_of_seven", wood, 7, -0.0137, 6},
                                         Known{"onion", onion, 9, 0.0041, 1.5}, Known{"citrus", citrus, 9, 0.0041, 0}),
                         [](const auto& info) { return std::string(info.param.name); });

} // namespace
} // namespace kerf::texture::error_test
