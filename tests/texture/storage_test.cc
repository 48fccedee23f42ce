// How pictures are stored, and in which order they are named, must not matter.

#include "image/file.h"
#include "image/filters.h"
#include "tests/support/checkout.h"
#include "tests/texture/probes.h"
#include "tests/texture/stored.h"

#include <gtest/gtest.h>

namespace kerf::texture::storage_test {
namespace {

using Change = std::vector<Exemplar> (*)(const std::vector<Exemplar>&);

struct Stored {
  const char* name;
  Change change;
};
void PrintTo(const Stored& stored, std::ostream* out) { *out << stored.name; }

template <class One>
std::vector<Exemplar> each(const std::vector<Exemplar>& all, const One& one) {
  std::vector<Exemplar> result;
  for (const Exemplar& e : all)
    result.push_back(one(e));
  return result;
}

/// Blurred, so that what lies between pixels is no noise.
Exemplar photograph(const std::string& name, const double height, const double pixel) {
  Exemplar e{name, image::read_image(support::checkout() + "/params/sections/fruit/" + name + "_whole.png"),
             Background::alpha, SectionPlane(Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY())};
  e.picture.colours = image::blurred(image::filled(e.picture.colours, mask_of(e.picture, e.background)), 1.5);
  const Vec3 step(0.5 * pixel * e.picture.width(), 0.5 * pixel * e.picture.height(), 0);
  e.plane = SectionPlane(Vec3(0, 0, height) - step, pixel * Vec3::UnitX(), pixel * Vec3::UnitY());
  e.fit = Fit::rigid;
  return e;
}

/// What two interiors show differently, on average and the largest, of 255.
std::array<double, 2> apart(const Interior& a, const Interior& b, const Blending& how) {
  std::array<double, 2> result = {0, 0};
  const Points points = points_inside(3000, 21, 0.045);
  for (const Vec3& p : points) {
    const double d = 255 * difference(a.colour(p, how), b.colour(p, how));
    result[0] += d / static_cast<double>(points.size());
    result[1] = std::max(result[1], d);
  }
  return result;
}

class Storage : public testing::TestWithParam<Stored> {
 protected:
  static void expect_same(const char* what, const std::vector<Exemplar>& exemplars, const double most) {
    const Interior before(exemplars, ball(4), {}), after(GetParam().change(exemplars), ball(4), {});
    const auto plain = apart(before, after, {.morph = Morph::blend}), warped = apart(before, after, {});
    const auto effect = apart(before, before, {}); // nothing
    double moved = 0;                              // by warps
    for (const Vec3& p : points_inside(3000, 21, 0.045))
      moved += 255 * difference(before.colour(p), before.colour(p, {.morph = Morph::blend})) / 3000;
    std::printf("%s, %s: blend %.2f on average, %.1f at most; with warps %.2f, %.1f; warps move %.1f\n",
                GetParam().name, what, plain[0], plain[1], warped[0], warped[1], moved);
    EXPECT_EQ(effect[1], 0);
    EXPECT_GT(moved, 1.5) << "warps do nothing: nothing is tested";
    EXPECT_LT(plain[0], 1.5); // pixels between pixels
    EXPECT_LT(warped[0], 1.75 * plain[0] + most);
  }
};

TEST_P(Storage, MakesNoDifferenceToPhotographs) {
  expect_same("orange and kiwi", {photograph("orange", -0.03, 0.0002), photograph("kiwi", 0.03, 0.0004)}, 0.5);
}

TEST_P(Storage, MakesNoDifferenceToSolids) {
  std::vector<Exemplar> exemplars;
  for (int i = 0; i < 3; ++i)
    exemplars.push_back(
      exemplar_of("e" + std::to_string(i), onion, Vec3(0, 0, 0.02 * (i - 1)), Vec3::UnitX(), Vec3::UnitY(), 150));
  exemplars.push_back(exemplar_of("upright", onion, Vec3(0.001, 0, 0), Vec3::UnitY(), Vec3::UnitZ(), 150));
  expect_same("onion", exemplars, 1);
}

INSTANTIATE_TEST_SUITE_P(
  All, Storage,
  testing::Values(Stored{"turned", [](const auto& all) { return each(all, turned); }},
                  Stored{"mirrored", [](const auto& all) { return each(all, mirrored); }},
                  Stored{"one_turned",
                         [](const auto& all) {
                           auto result = all;
                           result[0] = turned(all[0]);
                           return result;
                         }},
                  Stored{"by_half_a_radian",
                         [](const auto& all) { return each(all, [](const auto& e) { return turned_by(e, 0.5); }); }},
                  Stored{"reversed", [](const auto& all) { return std::vector<Exemplar>(all.rbegin(), all.rend()); }}),
  [](const auto& info) { return std::string(info.param.name); });

} // namespace
} // namespace kerf::texture::storage_test
