#include "texture/interior.h"

#include "base/error.h"
#include "base/parallel.h"
#include "tests/output/samples.h"
#include "tests/texture/probes.h"
#include "tests/texture/refused.h"
#include "texture/atlas.h"
#include "texture/cache.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <fstream>

namespace kerf::texture::interior_test {
namespace {

const Interior& five() {
  static const Interior interior(axis_exemplars(onion, 5, 120), ball(3), InteriorOptions());
  return interior;
}

TEST(Interior, IsExactOnTheExemplars) {
  for (const auto morph : {Morph::first_order, Morph::exact_inverse, Morph::blend, Morph::nearest})
    for (const auto weights : {Weights::shepard, Weights::mean_value}) {
      const Interior& inside = five();
      double largest = 0;
      for (const Chart& chart : inside.charts())
        for (int r = 10; r < chart.inside.height; r += 7)
          for (int c = 10; c < chart.inside.width; c += 7) {
            const Vec3 p = chart.plane.point(chart.plane.to_local(Vec2(c, r)));
            // Where two planes meet, which of them counts depends on round-off; their pictures agree to a pixel.
            bool at_another = p.norm() > 0.046;
            for (const Chart& other : inside.charts())
              at_another |= &other != &chart && std::abs(other.plane.height(p)) < 1e-3;
            if (!at_another)
              largest = std::max(largest, difference(inside.colour(p, {morph, weights, 1}), chart.colours(c, r)));
          }
      EXPECT_LT(largest, 2e-3);
    }
}

TEST(Interior, IsContinuousAcrossPlanesAndInCells) {
  const Interior& inside = five();
  const Blending how = inside.options().blending;
  double across = 0, within = 0, slope = 0;
  for (const Vec3& p : points_inside(3000, 2)) {
    const Vec3 step(3e-9, -2e-9, 4e-9);
    within = std::max(within, difference(inside.colour(p, how), inside.colour(p + step, how)));
    const Vec3 larger = 1e-6 * Vec3(1, -1, 1);
    slope = std::max(slope, difference(inside.colour(p, how), inside.colour(p + larger, how)));
    for (const Chart& chart : inside.charts()) {
      const Vec3 on = p - chart.plane.height(p) * chart.plane.normal();
      if (on.norm() > 0.045)
        continue;
      bool near_another = false;
      for (const Chart& other : inside.charts())
        near_another |= &other != &chart && std::abs(other.plane.height(on)) < 1e-4;
      if (!near_another)
        across = std::max(across, difference(inside.colour(on + 1e-11 * chart.plane.normal(), how),
                                             inside.colour(on - 1e-11 * chart.plane.normal(), how)));
    }
  }
  RecordProperty("largest jump across a plane", std::to_string(across));
  std::printf("largest change: over 2e-11 m across a plane %.2e, over 5e-9 m in cells %.2e, over 1.7e-6 m %.2e\n",
              across, within, slope);
  EXPECT_LT(across, 1e-4);
  EXPECT_LT(within, 1e-3);
  EXPECT_LT(slope, 0.1);
}

TEST(Interior, WarpsDoNotFold) { EXPECT_GT(five().smallest_determinant(), 0); }

TEST(Interior, SameBitsWithAnyNumberOfThreadsAndInAnyOrder) {
  const auto points = points_inside(500, 5);
  const auto colours = [&](const int threads) {
    set_n_threads(threads);
    const Interior inside(axis_exemplars(citrus, 3, 80), ball(3), {});
    const Detail detail(inside);
    std::vector<Eigen::Array4f> result(points.size());
    for (std::size_t i = 0; i < points.size(); ++i)
      result[i] = inside.colour(points[i]);
    const Patch patch{Vec3(-0.03, -0.03, 0.01), 5e-4 * Vec3::UnitX(), 5e-4 * Vec3::UnitY(), 100, 100};
    const auto painted = paint(inside, patch, &detail);
    result.insert(result.end(), painted.values.begin(), painted.values.end());
    return result;
  };
  const auto one = colours(1), two = colours(2);
  set_n_threads(2);
  for (std::size_t i = 0; i < one.size(); ++i)
    ASSERT_TRUE((one[i] == two[i]).all()) << i;
  const Interior& inside = five();
  std::vector<Eigen::Array4f> forward, backward;
  for (std::size_t i = 0; i < points.size(); ++i)
    forward.push_back(inside.colour(points[i]));
  for (std::size_t i = points.size(); i-- > 0;)
    backward.push_back(inside.colour(points[i]));
  for (std::size_t i = 0; i < points.size(); ++i)
    ASSERT_TRUE((forward[i] == backward[points.size() - 1 - i]).all());
}

/// The largest change of a colour when a body and its exemplars are turned and shifted together.
double change_by_turning(std::vector<Exemplar> exemplars) {
  const Mat3 turn = Eigen::AngleAxisd(0.8, Vec3(1, 2, -0.5).normalized()).toRotationMatrix();
  const Vec3 shift(0.3, -0.2, 0.1);
  auto body = ball(3);
  const Interior before(exemplars, body, {});
  for (Exemplar& e : exemplars) {
    const auto at = [&](const Vec2& pixel) { return Vec3(turn * e.plane.point(e.plane.to_local(pixel)) + shift); };
    e.plane = SectionPlane(at(Vec2(0, 0)), at(Vec2(1, 0)) - at(Vec2(0, 0)), at(Vec2(0, 1)) - at(Vec2(0, 0)));
  }
  for (Vec3& v : body.vertices)
    v = turn * v + shift;
  const Interior after(exemplars, body, {});
  double largest = 0;
  for (const Vec3& p : points_inside(1000, 7))
    largest = std::max(largest, difference(before.colour(p), after.colour(turn * p + shift)));
  std::printf("largest change of a colour when all is turned and shifted: %.1e\n", largest);
  return largest;
}

TEST(Interior, TurningAllOfItChangesNothing) {
  auto exemplars = axis_exemplars(onion, 3, 100);
  EXPECT_LT(change_by_turning(exemplars), 1e-5);
  for (Exemplar& e : exemplars)
    e.fit = Fit::rigid;
  EXPECT_LT(change_by_turning(exemplars), 1e-3); // found by descents, from round-off on
}

TEST(Interior, MirroredInputGivesMirroredOutput) {
  // A solid symmetric in x, sections symmetric in x: colours are.
  const Solid solid = [](const Vec3& p) {
    const double spot = Vec3(std::abs(p[0]) - 0.02, p[1] - 0.01, p[2]).norm();
    return mixed({0.9f, 0.5f, 0.1f}, {0.2f, 0.3f, 0.8f}, soft_step(spot - 0.012, 0.002));
  };
  const std::vector<Exemplar> exemplars = {
    exemplar_of("z", solid, Vec3(0, 0, 0.001), Vec3::UnitX(), Vec3::UnitY(), 101),
    exemplar_of("y", solid, Vec3(0, 0.002, 0), Vec3::UnitX(), Vec3::UnitZ(), 101)};
  const Interior inside(exemplars, ball(4), {});
  // Warps are found by a descent whose sums run from left to right: their halves differ by a hundredth of a pixel.
  for (const auto& [morph, most] : {std::pair(Morph::blend, 1e-5), std::pair(Morph::first_order, 1e-3)}) {
    const Blending how{morph, Weights::shepard, 1};
    double largest = 0;
    for (const Vec3& p : points_inside(1000, 9))
      largest = std::max(largest, difference(inside.colour(p, how), inside.colour(Vec3(-p[0], p[1], p[2]), how)));
    std::printf("largest difference of mirrored colours: %.1e\n", largest);
    EXPECT_LT(largest, most);
  }
}

TEST(Interior, WarpsBeatTheBlendWhereFeaturesAreContinuous) {
  // Two parallel sections of a cone of rings, and the one midway.
  const Solid cone = [](const Vec3& p) {
    const double r = std::hypot(p[0], p[1]) + 0.35 * p[2];
    return image::Rgb::Constant(static_cast<float>(0.5 + 0.4 * std::sin(r / 0.0035)));
  };
  const std::vector<Exemplar> exemplars = {
    exemplar_of("low", cone, Vec3(0, 0, -0.012), Vec3::UnitX(), Vec3::UnitY(), 160),
    exemplar_of("high", cone, Vec3(0, 0, 0.012), Vec3::UnitX(), Vec3::UnitY(), 160)};
  const Interior inside(exemplars, ball(4), {});
  const auto error = [&](const Morph morph) {
    double sum = 0;
    for (int r = -20; r <= 20; ++r)
      for (int c = -20; c <= 20; ++c) {
        const Vec3 p(0.0015 * c, 0.0015 * r, 0);
        if (p.norm() < 0.03)
          sum += std::pow(inside.colour(p, {morph, Weights::shepard, 1})[0] - cone(p)[0], 2);
      }
    return 10 * std::log10(sum);
  };
  EXPECT_LT(error(Morph::first_order), error(Morph::blend) - 2); // dB
}

TEST(Pins, JoinFacesAtRightAnglesUnderFacing) {
  const auto exemplars = axis_exemplars(onion, 2, 80); // z = 0.0005 and x = 0.0005
  InteriorOptions options;
  options.warps.partners = Partners::facing;
  const Interior without(exemplars, ball(3), options);
  EXPECT_EQ(without.n_pairs(), 0u);
  options.warps.pins = {{"p", {"e0", "e1"}, {Vec3(0.015, 0.01, 0.0005), Vec3(0.0005, 0.02, 0.02)}}};
  const Interior with(exemplars, ball(3), options);
  EXPECT_EQ(with.n_pairs(), 1u); // in the one cell that both points bound
  double change = 0;
  for (const Vec3& p : points_inside(500, 6))
    change = std::max(change, difference(with.colour(p), without.colour(p)));
  EXPECT_GT(change, 0.05);
}

TEST(Cache, ComesBackAndSurvivesDamage) {
  const output::TemporaryFolder folder;
  const auto exemplars = axis_exemplars(onion, 2, 60);
  const auto body = ball(2);
  const InteriorOptions options;
  const Interior found(exemplars, body, options);
  const auto hash = input_hash(exemplars, body, options);
  const auto file = cache_file(folder / "cache", hash);
  EXPECT_FALSE(load_maps(file, hash));
  ASSERT_TRUE(save_maps(file, hash, found.maps()));
  const auto maps = load_maps(file, hash);
  ASSERT_TRUE(maps);
  const Interior known(exemplars, body, options, &*maps);
  for (const Vec3& p : points_inside(200, 4))
    EXPECT_TRUE((known.colour(p) == found.colour(p)).all());
  EXPECT_FALSE(load_maps(file, hash + 1));
  auto other = exemplars;
  other[0].picture.colours(20, 20)[1] += 0.01f;
  EXPECT_NE(input_hash(other, body, options), hash);
  std::filesystem::resize_file(file, std::filesystem::file_size(file) - 5);
  EXPECT_FALSE(load_maps(file, hash));
  std::ofstream(file) << "nonsense";
  EXPECT_FALSE(load_maps(file, hash));
  std::ofstream(folder / "plain") << "a file where a folder should be";
  EXPECT_FALSE(save_maps(cache_file(folder / "plain", hash), hash, found.maps()));
}

TEST(BadInput, IsRefused) {
  const auto good = axis_exemplars(onion, 2, 60);
  auto bad = good;
  bad[1].plane = SectionPlane(Vec3(0, 0, 1), Vec3(0.001, 0, 0), Vec3(0, 0.001, 0));
  expect_refused(bad, "Origin [m]", "misses the body");
  bad = good;
  bad.push_back(good[0]);
  expect_refused(bad, "Origin [m]", "lies in the plane of exemplar e0");
  bad = good;
  bad[0].picture = image::Image{image::Colours(1, 1, image::Rgb::Zero()), {}};
  expect_refused(bad, "Image", "at least 8 x 8 pixels");
  bad = good;
  bad[0].picture.alpha = image::Grey(60, 60, 0);
  bad[0].background = Background::alpha;
  expect_refused(bad, "Image", "its mask is empty");
  bad = good;
  bad[0].picture.colours = image::Colours(60, 60, image::Rgb::Zero());
  bad[0].background = Background::black;
  expect_refused(bad, "Image", "its mask is empty");
  expect_refused({}, "Exemplar", "at least one exemplar");
  InteriorOptions options;
  options.warps.pins = {{"p", {"e0", "e1"}, {Vec3(0.2, 0, 0.0005), Vec3(0.0005, 0.01, 0.01)}}};
  expect_refused(good, "From [m]", "outside", options);
  options.warps.pins = {{"p", {"e0", "e1"}, {Vec3(0.01, 0.01, 0.0005), Vec3(0.0005, 0.2, 0.01)}}};
  expect_refused(good, "To [m]", "outside", options);
  options.warps.pins = {{"p", {"e0", "e1"}, {Vec3(0.01, 0.01, 0.006), Vec3(0.0005, 0.01, 0.01)}}};
  expect_refused(good, "From [m]", "off the plane of exemplar e0", options);
  options.warps.pins = {{"p", {"e0", "e1"}, {Vec3(0.01, 0.01, 0.0005), Vec3(0.006, 0.01, 0.01)}}};
  expect_refused(good, "To [m]", "off the plane of exemplar e1", options);
  EXPECT_THROW(SectionPlane(Vec3::Zero(), Vec3::Zero(), Vec3::UnitX()), ParameterError);
  EXPECT_THROW(SectionPlane(Vec3::Zero(), Vec3::UnitX(), Vec3::Zero()), ParameterError);
  EXPECT_THROW(SectionPlane(Vec3::Zero(), Vec3::UnitX(), Vec3(-2, 0.001, 0)), ParameterError);
}

TEST(Fit, DrawsAPartialPictureToTheSection) {
  auto exemplars = axis_exemplars(citrus, 1, 120);
  image::Image& picture = exemplars[0].picture;
  picture.alpha = image::Grey(120, 120, 0);
  for (int r = 0; r < 120; ++r) // an ellipse, off the middle
    for (int c = 0; c < 120; ++c)
      picture.alpha(c, r) = std::hypot((c - 50) / 40.0, (r - 65) / 30.0) < 1 ? 1.0f : 0.0f;
  exemplars[0].background = Background::alpha;
  for (const Fit fit : {Fit::rigid, Fit::harmonic}) {
    exemplars[0].fit = fit;
    const Interior inside(exemplars, ball(3), {});
    EXPECT_GT(inside.smallest_determinant(), 0);
    EXPECT_LT(inside.charts()[0].fit_error.mean, 0.5); // pixels
  }
}

} // namespace
} // namespace kerf::texture::interior_test
