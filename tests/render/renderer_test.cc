#include "render/renderer.h"

#include "base/error.h"
#include "tests/render/shapes.h"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <random>

namespace kerf::render::renderer_test {
namespace {

const std::vector<DrawnSurface> no_surfaces;
const std::vector<DrawnBlade> no_blades;

Camera camera_on_x(int width, int height) {
  return {.eye = {4, 0, 0}, .field_of_view = 40, .width = width, .height = height};
}

Image draw(const Camera& camera, const Look& look, const shapes::Mesh& mesh) {
  const std::vector surfaces = {mesh.drawn()};
  return Renderer(camera, look).draw({surfaces, no_blades, {}});
}

int difference(const std::array<std::uint8_t, 3>& a, const std::array<std::uint8_t, 3>& b) {
  return std::abs(a[0] - b[0]) + std::abs(a[1] - b[1]) + std::abs(a[2] - b[2]);
}

std::size_t n_different_pixels(const Image& a, const Image& b, int threshold) {
  std::size_t n = 0;
  for (int row = 0; row < a.height; ++row)
    for (int column = 0; column < a.width; ++column)
      n += difference(a.pixel(column, row), b.pixel(column, row)) > threshold ? 1 : 0;
  return n;
}

/// Dark tissue before white, so that a pixel that is half covered can be told by its value.
Look contrasting() { return {.skin = Vec3::Zero(), .background_top = Vec3::Ones(), .background_bottom = Vec3::Ones()}; }

/// Pixels that are more than half covered by something dark before white: sRGB 188 is half the light of 255.
std::size_t n_covered(const Image& image) {
  std::size_t n = 0;
  for (std::size_t i = 1; i < image.rgb.size(); i += 3)
    n += image.rgb[i] < 188 ? 1 : 0;
  return n;
}

TEST(Renderer, AnEmptySceneIsTheBackground) {
  const Look look{.background_top = {1, 0.5, 0.2}, .background_bottom = {0, 0.3, 0.2}};
  const Image image = Renderer(camera_on_x(40, 30), look).draw({no_surfaces, no_blades, {}});
  ASSERT_EQ(image.rgb.size(), 3600u);
  for (int row = 0; row < image.height; ++row) {
    const Vec3 wanted =
      255 * (look.background_top + (row + 0.5) / image.height * (look.background_bottom - look.background_top));
    for (int column = 0; column < image.width; ++column)
      for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(image.pixel(column, row)[k], wanted[k], 0.51);
  }
}

TEST(Renderer, ASphereCoversItsDisk) {
  // From distance d a sphere of radius r is seen within the angle asin(r / d).
  const Image image = draw(camera_on_x(320, 240), contrasting(), shapes::sphere(1, 6));
  const double lens = std::tan(20 * std::numbers::pi / 180);
  const double radius = std::tan(std::asin(1.0 / 4)) / lens * 120;
  const double area = std::numbers::pi * radius * radius;
  EXPECT_NEAR(static_cast<double>(n_covered(image)), area, 0.01 * area);
}

TEST(Renderer, TheImageStandsUpright) {
  // Seen from +x with z up, +y is to the right.
  auto mesh = shapes::sphere(0.2, 4);
  for (Vec3& p : mesh.positions)
    p += Vec3(0, 0.7, 0.5);
  const Image image = draw(camera_on_x(160, 120), contrasting(), mesh);
  const double pixels_per_metre = 60 / (4 * std::tan(20 * std::numbers::pi / 180));
  const int right = static_cast<int>(80 + 0.7 * pixels_per_metre), high = static_cast<int>(60 - 0.5 * pixels_per_metre);
  EXPECT_LT(image.pixel(right, high)[1], 100);
  EXPECT_GT(image.pixel(160 - right, high)[1], 250);
  EXPECT_GT(image.pixel(right, 120 - high)[1], 250);
}

TEST(Renderer, RevealedFacesDifferFromSkin) {
  auto mesh = shapes::cube(1.2);
  const Camera camera = camera_on_x(80, 60);
  const Image revealed = draw(camera, {}, mesh);
  mesh.labels.assign(mesh.labels.size(), 0);
  const Image skin = draw(camera, {}, mesh);
  const auto r = revealed.pixel(40, 30), s = skin.pixel(40, 30);
  EXPECT_GT(difference(r, s), 100);
  EXPECT_GT(s[0], s[1] + 40); // red
  EXPECT_GT(r[1], s[1] + 40); // lighter
  mesh.labels.clear();
  EXPECT_EQ(draw(camera, {}, mesh).rgb, skin.rgb);
}

TEST(Renderer, CutsHaveTheirOwnColours) {
  const Look look;
  EXPECT_EQ(look.colour(0), look.skin);
  EXPECT_EQ(look.colour(1), look.revealed);
  for (int k = 1; k < 6; ++k) {
    EXPECT_GT((look.colour(k) - look.colour(k + 1)).norm(), 0.02);
    EXPECT_GT((look.colour(k) - look.skin).norm(), 0.3);
  }
}

TEST(Renderer, ABladeIsVisibleAndHidesWhatIsBehind) {
  const auto mesh = shapes::sphere(0.8, 5);
  const std::vector surfaces = {mesh.drawn()};
  const std::vector blades = {DrawnBlade{{{1.2, -0.5, -0.1}, {1.2, 0.5, -0.1}}, {0.02, 0, 0.2}}};
  const Renderer renderer(camera_on_x(160, 120), {});
  const Image without = renderer.draw({surfaces, no_blades, {}}), with = renderer.draw({surfaces, blades, {}});
  // At 2.8 m from the eye the plate is 1 m by 0.2 m.
  const double pixels_per_metre = 60 / (2.8 * std::tan(20 * std::numbers::pi / 180));
  EXPECT_GT(n_different_pixels(without, with, 60), 0.9 * 0.2 * pixels_per_metre * pixels_per_metre);
  const auto steel = with.pixel(80, 60);
  EXPECT_LT(std::abs(steel[0] - steel[2]), 30); // grey
}

TEST(Renderer, ARodIsVisible) {
  const DrawnRod rod{{{1.2, -0.5, 0}, {1.2, 0.5, 0}}, 0.1};
  const Renderer renderer(camera_on_x(160, 120), {});
  const Image without = renderer.draw({}), with = renderer.draw({{}, {}, {rod}});
  const double pixels_per_metre = 60 / (2.8 * std::tan(20 * std::numbers::pi / 180));
  const double n_wanted = 0.2 * pixels_per_metre * pixels_per_metre;
  EXPECT_NEAR(n_different_pixels(without, with, 60), n_wanted, 0.2 * n_wanted);
}

TEST(Renderer, ABladeInTheLightCastsAShadow) {
  shapes::Mesh floor{{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}, {}};
  const std::vector surfaces = {floor.drawn()};
  const std::vector blades = {DrawnBlade{{{-0.3, -0.1, 0.3}, {0.3, -0.1, 0.3}}, {0, 0.3, 0}}};
  const Camera above{.eye = {0, -2, 3}, .target = {0, 0, 0}, .up = {0, 0, 1}, .width = 160, .height = 120};
  const Renderer renderer(above, {});
  const Image without = renderer.draw({surfaces, no_blades, {}}), with = renderer.draw({surfaces, blades, {}});
  std::size_t n_darker = 0;
  for (std::size_t i = 0; i < with.rgb.size(); i += 3)
    n_darker += without.rgb[i] > with.rgb[i] + 25 && with.rgb[i] > with.rgb[i + 2] + 25 ? 1 : 0; // still red: not steel
  EXPECT_GT(n_darker, 150u);
}

TEST(Renderer, ALitPlaneHasNoShadowOfItsOwn) {
  // Without a tilt-aware bias a slanted plane shows stripes of its own shadow.
  for (const double slope : {0.0, 0.5, 1.5}) {
    shapes::Mesh plane{{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}, {}};
    for (Vec3& p : plane.positions)
      p.z() = slope * p.y();
    const Camera above{.eye = {0, -1, 4}, .target = {0, 0, 0}, .up = {0, 1, 0}, .width = 160, .height = 120};
    const Image image = draw(above, {}, plane);
    for (int row = 50; row < 70; ++row)
      for (int column = 70; column < 90; ++column)
        EXPECT_LE(difference(image.pixel(column, row), image.pixel(column + 1, row)), 4) << slope;
  }
}

TEST(Renderer, TheSameSceneGivesTheSameBytes) {
  const auto mesh = shapes::sphere(0.9, 5);
  const std::vector surfaces = {mesh.drawn()};
  const std::vector blades = {DrawnBlade{{{1, -0.5, 0}, {1, 0.5, 0.2}}, {0.3, 0, 0.3}}};
  const Renderer renderer(camera_on_x(200, 150), {});
  const Image first = renderer.draw({surfaces, blades, {}});
  renderer.draw({no_surfaces, blades, {}});
  EXPECT_EQ(renderer.draw({surfaces, blades, {}}).rgb, first.rgb);
  EXPECT_EQ(Renderer(camera_on_x(200, 150), {}).draw({surfaces, blades, {}}).rgb, first.rgb);
}

TEST(Renderer, FarFromTheOriginTheImageIsTheSame) {
  auto mesh = shapes::sphere(0.9, 4);
  Camera camera = camera_on_x(80, 60);
  const Image here = draw(camera, {}, mesh);
  const Vec3 away(1024, -2048, 4096); // exact in binary, so only the renderer can lose digits
  for (Vec3& p : mesh.positions)
    p += away;
  camera.eye += away;
  camera.target += away;
  EXPECT_EQ(n_different_pixels(here, draw(camera, {}, mesh), 3), 0u);
}

TEST(Renderer, TheUnitOfLengthDoesNotMatter) {
  auto mesh = shapes::sphere(0.9, 4);
  Camera camera = camera_on_x(80, 60);
  const Image metres = draw(camera, {}, mesh);
  for (Vec3& p : mesh.positions)
    p /= 1024;
  camera.eye /= 1024;
  EXPECT_LT(n_different_pixels(metres, draw(camera, {}, mesh), 6), 20u);
}

TEST(Renderer, WhatIsBehindTheEyeIsNotSeen) {
  auto mesh = shapes::sphere(0.5, 2);
  for (Vec3& p : mesh.positions)
    p.x() += 10;
  const Image image = draw(camera_on_x(40, 30), contrasting(), mesh);
  EXPECT_EQ(n_covered(image), 0u);
}

TEST(Renderer, LeavesNothingOfTheImageBefore) {
  // Only where triangles are is anything drawn or cleared; some of these reach beyond the image, or behind the eye.
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(-1.5, 1.5), size(0.05, 1);
  const Camera camera = camera_on_x(64, 48);
  const Renderer renderer(camera, {});
  const Image empty = renderer.draw({no_surfaces, no_blades, {}});
  int n_empty = 0;
  for (int k = 0; k < 12; ++k) {
    auto mesh = shapes::cube(size(random));
    const Vec3 at = {k % 5 == 0 ? 4 + place(random) : place(random), place(random), place(random)};
    for (Vec3& p : mesh.positions)
      p += at;
    const std::vector surfaces = {mesh.drawn()};
    const DrawnScene scene{surfaces, no_blades, {}};
    const Image image = renderer.draw(scene);
    EXPECT_EQ(image.rgb, Renderer(camera, {}).draw(scene).rgb) << k;
    n_empty += image.rgb == empty.rgb ? 1 : 0;
  }
  EXPECT_LE(n_empty, 4);
}

TEST(Renderer, RefusesWhatCannotBeDrawn) {
  const Renderer renderer(camera_on_x(8, 6), {});
  const auto draw_one = [&](const shapes::Mesh& mesh) {
    const std::vector surfaces = {mesh.drawn()};
    return renderer.draw({surfaces, no_blades, {}});
  };
  auto mesh = shapes::cube(1);
  mesh.labels.pop_back();
  EXPECT_THROW(draw_one(mesh), DataError);
  mesh = shapes::cube(1);
  mesh.triangles[3][1] = 8;
  EXPECT_THROW(draw_one(mesh), DataError);
  mesh = shapes::cube(1);
  mesh.positions[5].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(draw_one(mesh), NumericalError);
  EXPECT_THROW(Renderer(Camera{.field_of_view = 0}, {}), ParameterError);
}

} // namespace
} // namespace kerf::render::renderer_test
