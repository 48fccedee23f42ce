#include "texture/atlas.h"
#include "tests/texture/probes.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <algorithm>

namespace kerf::texture::atlas_test {
namespace {

const Interior& five() {
  static const Interior interior(axis_exemplars(onion, 5, 100), ball(3), InteriorOptions());
  return interior;
}

TEST(Atlas, KeepsWhatStays) {
  const Interior& inside = five();
  Points rest = {Vec3(0, 0, 0), Vec3(0.01, 0, 0), Vec3(0, 0.01, 0), Vec3(0.01, 0.01, 0.002)};
  std::vector<Triangle> triangles = {{0, 1, 2}};
  std::vector<std::uint16_t> labels = {1};
  Atlas atlas(0.001);
  EXPECT_EQ(atlas.fill({rest, triangles, labels}, {&inside}), 1u);
  const auto colours = atlas.colours();
  EXPECT_EQ(colours.size(), n_samples(atlas.parts()[0]));
  triangles.push_back({1, 3, 2});
  triangles.push_back({0, 2, 1});
  labels.insert(labels.end(), {2, 0});
  EXPECT_EQ(atlas.fill({rest, triangles, labels}, {&inside}), 1u); // the skin gets none
  EXPECT_EQ(atlas.first()[2], Atlas::none);
  EXPECT_TRUE(std::equal(colours.begin(), colours.end(), atlas.colours().begin()));
  EXPECT_EQ(atlas.fill({rest, triangles, labels}, {&inside}), 0u);
  // Both triangles have the same colour at the corner they share.
  EXPECT_EQ(atlas.colours()[atlas.first()[0] + n_samples(atlas.parts()[0]) - 1], atlas.colours()[atlas.first()[1]]);
  EXPECT_EQ(atlas.n_fills(), 2u); // the last one had nothing to fill
  rest[3][2] = 0.003;
  EXPECT_EQ(atlas.fill({rest, triangles, labels}, {&inside}), 1u);
  EXPECT_TRUE(std::equal(colours.begin(), colours.end(), atlas.colours().begin()));
  EXPECT_EQ(atlas.fill_of(), (std::vector<std::uint32_t>{1, 3, 0}));
}

std::vector<std::array<std::uint8_t, 3>> samples_of(const Atlas& atlas, const std::size_t t) {
  if (atlas.first()[t] == Atlas::none)
    return {};
  const auto first = atlas.colours().begin() + atlas.first()[t];
  return {first, first + static_cast<std::ptrdiff_t>(n_samples(atlas.parts()[t]))};
}

/// A strip, both of its sides, that becomes longer while its last vertices move on, as at a cut's front: it takes
/// hardly more room than a strip that is painted at once, and shows the same, to the bit. One that is read back from an
/// archive on the way goes on in the same way.
TEST(Atlas, UsesPlacesAgain) {
  const Interior& inside = five();
  Points rest;
  std::vector<Triangle> triangles;
  std::vector<std::uint16_t> labels;
  Atlas atlas(0.0007), resumed(0.0007);
  std::size_t n_filled = 0;
  for (int step = 0; step < 120; ++step) {
    const double front = -0.03 + 0.0005 * step;
    if (step % 8 == 0) {
      rest.insert(rest.end(), {Vec3(front, -0.004, 0.001), Vec3(front, 0.003, 0.002)});
      if (const auto n = static_cast<std::uint32_t>(rest.size()); n >= 4)
        for (const auto& [a, b, c] : {Triangle{n - 4, n - 2, n - 3}, Triangle{n - 3, n - 2, n - 1}}) {
          triangles.insert(triangles.end(), {{a, b, c}, {a, c, b}});
          labels.insert(labels.end(), {1, 1});
        }
    }
    rest[rest.size() - 2][0] = rest.back()[0] = front;
    const std::size_t n = atlas.fill({rest, triangles, labels}, {&inside});
    EXPECT_EQ(resumed.fill({rest, triangles, labels}, {&inside}), n);
    n_filled += n;
    Archive archive;
    archive(resumed);
    Archive back(archive.bytes(), "test");
    resumed = Atlas(0.0007);
    back(resumed);
    EXPECT_EQ(back.n_left(), 0u);
  }
  EXPECT_EQ(atlas.first(), resumed.first());
  EXPECT_EQ(atlas.colours(), resumed.colours());
  EXPECT_EQ(n_filled, 8 * triangles.size());
  Atlas anew(0.0007);
  anew.fill({rest, triangles, labels}, {&inside});
  std::vector<int> n_triangles_at(atlas.colours().size(), 0);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    EXPECT_EQ(samples_of(atlas, t), samples_of(anew, t)) << t;
    for (std::size_t i = 0; i < n_samples(atlas.parts()[t]); ++i)
      ++n_triangles_at[atlas.first()[t] + i];
  }
  EXPECT_EQ(*std::max_element(n_triangles_at.begin(), n_triangles_at.end()), 1);
  std::printf("room for %zu samples of a strip that has grown, %zu of one at once\n", atlas.colours().size(),
              anew.colours().size());
  EXPECT_LT(atlas.colours().size(), 1.2 * anew.colours().size());
}

/// Triangles that the skin gets make room for others.
TEST(Atlas, UsesPlacesOfWhatTheSkinGets) {
  const Points rest = {Vec3(0, 0, 0), Vec3(0.01, 0, 0), Vec3(0, 0.01, 0), Vec3(0.01, 0.01, 0)};
  const std::vector<Triangle> triangles = {{0, 1, 2}, {1, 3, 2}};
  Atlas atlas(0.001);
  const std::vector<std::uint16_t> before = {1, 0}, after = {0, 1};
  atlas.fill({rest, triangles, before}, {&five()});
  const std::size_t n = atlas.colours().size();
  atlas.fill({rest, triangles, after}, {&five()});
  EXPECT_EQ(atlas.first(), (std::vector<std::uint32_t>{Atlas::none, 0}));
  EXPECT_EQ(atlas.colours().size(), n);
  EXPECT_TRUE(samples_of(atlas, 0).empty());
}

TEST(Atlas, SlopesAreThoseOfTheRelief) {
  // Luminance rises by 4 a metre along x: a relief of 1 mm rises by 0.004 along an edge of one metre.
  const Solid ramp = [](const Vec3& p) { return image::Rgb::Constant(static_cast<float>(0.5 + 4 * p[0])); };
  const Interior inside({exemplar_of("z", ramp, Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY(), 120)}, ball(3), {});
  const Points rest = {Vec3(0, 0, 0), Vec3(0.01, 0.002, 0), Vec3(-0.004, 0.01, 0)};
  const std::vector<Triangle> triangles = {{0, 1, 2}};
  const std::vector<std::uint16_t> labels = {1};
  for (const double relief : {0.001, -0.002}) {
    Atlas atlas(0.002);
    atlas.fill({rest, triangles, labels}, {&inside, nullptr, nullptr, relief});
    ASSERT_EQ(atlas.slopes().size(), atlas.colours().size());
    for (const auto& [along_first, along_second] : atlas.slopes()) {
      EXPECT_NEAR(along_first, relief * 4 * 0.01, 1e-3 * 0.04 * std::abs(relief));
      EXPECT_NEAR(along_second, relief * 4 * -0.004, 1e-3 * 0.04 * std::abs(relief));
    }
  }
}

TEST(Atlas, BothSidesOfACutShowTheSame) {
  // A triangle, all other orders of its corners, and one that shares but two of them: as each is painted alone.
  const Interior& inside = five();
  const Detail detail(inside);
  const Paint paint = {&inside, &detail, nullptr, 0.001};
  const Points rest = {Vec3(0.003, 0.001, 0.002), Vec3(0.012, 0, 0.001), Vec3(0.002, 0.009, 0.004),
                       Vec3(0.011, 0.01, 0)};
  const std::vector<Triangle> triangles = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}, {1, 3, 2}};
  const std::vector<std::uint16_t> labels(triangles.size(), 1);
  Atlas together(0.001);
  EXPECT_EQ(together.fill({rest, triangles, labels}, paint), triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    Atlas alone(0.001);
    alone.fill({rest, std::span(triangles).subspan(t, 1), std::span(labels).first(1)}, paint);
    ASSERT_EQ(together.parts()[t], alone.parts()[0]);
    for (std::size_t i = 0; i < alone.colours().size(); ++i) {
      const std::size_t at = together.first()[t] + i;
      for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(together.colours()[at][k], alone.colours()[i][k], 1); // round-off
      for (int k = 0; k < 2; ++k)
        EXPECT_NEAR(together.slopes()[at][k], alone.slopes()[i][k], 6e-4); // differences over two pixels
    }
  }
}

/// What two triangles that meet at an angle show differently along their common side, of 255: the largest, the mean.
std::array<double, 2> step_at_a_side(const Paint& paint, const double angle) {
  double largest = 0, sum = 0, n = 0;
  for (const Vec3& p : points_inside(40, 17, 0.03)) {
    const Points rest = {p, p + Vec3(0.008, 0, 0), p + Vec3(0.004, 0.006, 0),
                         p + Vec3(0.004, 0, 0) + 0.006 * Vec3(0, -std::cos(angle), -std::sin(angle))};
    const std::vector<Triangle> triangles = {{0, 1, 2}, {1, 0, 3}};
    const std::vector<std::uint16_t> labels = {1, 1};
    Atlas atlas(0.001);
    atlas.fill({rest, triangles, labels}, paint);
    const int parts = atlas.parts()[0]; // of both: they are as large as each other
    std::vector<std::uint32_t> first_side, second_side;
    for (std::size_t t = 0; t < 2; ++t) {
      std::uint32_t sample = atlas.first()[t];
      for_each_sample(parts, [&](int, const int j) {
        if (j == 0)
          (t == 0 ? first_side : second_side).push_back(sample);
        ++sample;
      });
    }
    for (std::size_t i = 0; i < first_side.size(); ++i)
      for (int channel = 0; channel < 3; ++channel) {
        const double step = std::abs(int(atlas.colours()[first_side[i]][channel]) -
                                     int(atlas.colours()[second_side[first_side.size() - 1 - i]][channel]));
        largest = std::max(largest, step);
        sum += step;
        ++n;
      }
  }
  return {largest, sum / n};
}

TEST(Atlas, NeighboursAgreeAtTheirCommonSide) {
  const Detail detail(five());
  for (const double degrees : {0.0, 0.9, 1.5, 3.0, 10.0, 30.0}) {
    const double angle = degrees * M_PI / 180;
    const auto [plain, plain_mean] = step_at_a_side({&five()}, angle);
    const auto [detailed, detailed_mean] = step_at_a_side({&five(), &detail}, angle);
    std::printf("triangles at %4.1f degrees: plain %.0f of 255, with small features %.0f, %.2f on average\n", degrees,
                plain, detailed, detailed_mean);
    EXPECT_LE(plain, 1);
    EXPECT_LE(detailed_mean, degrees < 1 ? 0.5 : 2 + 0.15 * degrees); // below a degree they share windows
    EXPECT_LE(detailed, degrees == 0 ? 1 : 60);
  }
}

/// Triangles that are painted together, in a plane that is nearly theirs, against each painted in its own.
TEST(Atlas, WhatIsPaintedInAPlaneNearItLooksAlike) {
  const Detail detail(five());
  const Paint paint = {&five(), &detail};
  const double pixel = five().pixel();
  double sum = 0, n = 0, differ = 0;
  for (const Vec3& p : points_inside(25, 29, 0.03)) {
    // The second one, 6 pixels long, leans by .9 degrees and lies a seventh of a pixel higher.
    const Vec3 up = pixel * Vec3(0, 0, 1), across = pixel * Vec3(0, 6, 0), along = pixel * Vec3(6, 0, 0);
    const Points rest = {
      p, p + along, p + across, p + along + 0.14 * up, p + along + across + 0.14 * up, p + 2 * along + 0.234 * up};
    const std::vector<Triangle> triangles = {{0, 1, 2}, {3, 4, 5}};
    const std::vector<std::uint16_t> labels = {1, 1};
    Atlas together(0.5 * pixel), alone(0.5 * pixel);
    together.fill({rest, triangles, labels}, paint);
    alone.fill({rest, std::span(triangles).subspan(1), std::span(labels).first(1)}, paint);
    for (std::size_t i = 0; i < alone.colours().size(); ++i)
      for (int channel = 0; channel < 3; ++channel) {
        const double step =
          std::abs(int(together.colours()[together.first()[1] + i][channel]) - int(alone.colours()[i][channel]));
        sum += step;
        differ += step > 0 ? 1 : 0;
        ++n;
      }
  }
  std::printf("in a plane nearby: %.2f of 255 on average, %.0f %% differ\n", sum / n, 100 * differ / n);
  EXPECT_GT(differ, 0);
  EXPECT_LT(sum / n, 1.5);
}

/// Triangles see windows on a lattice between whose points source points are interpolated; pictures of planes do not.
TEST(Atlas, SmallFeaturesAreThoseOfPictures) {
  const Interior& inside = five();
  const Detail detail(inside);
  const Vec3 x = in_plane(inside.charts().front().body_axes, Vec3::UnitZ()), y = Vec3::UnitZ().cross(x);
  const double pixel = inside.pixel();
  double with = 0, without = 0, n = 0;
  for (const Vec3& p : points_inside(40, 23, 0.03)) {
    const Points rest = {p, p + 0.008 * x, p + 0.006 * y};
    const std::vector<Triangle> triangles = {{0, 1, 2}};
    const std::vector<std::uint16_t> labels = {1};
    Atlas atlas(0.02);
    atlas.fill({rest, triangles, labels}, {&inside, &detail});
    const std::array<int, 3> corner_of_sample = {0, 2, 1};
    for (int i = 0; i < 3; ++i) {
      const Vec3& corner = rest[corner_of_sample[i]];
      const Patch patch{corner, pixel * x, pixel * y, 1, 1};
      const auto bytes = atlas.colours()[atlas.first()[0] + i];
      const Colour seen(bytes[0] / 255.0f, bytes[1] / 255.0f, bytes[2] / 255.0f, 0);
      const auto gap = [&](const Colour& c) { return (c - seen).head<3>().abs().mean(); };
      with += gap(paint(inside, patch, &detail)(0, 0));
      without += gap(inside.colour(corner));
      ++n;
    }
  }
  std::printf("corners of triangles against pictures of their plane: %.4f on average, against no small features %.4f\n",
              with / n, without / n);
  EXPECT_LT(with, 0.6 * without);
}

TEST(Atlas, CountsTrianglesThatAreTooLargeForTheirResolution) {
  const Points rest = {Vec3(0, 0, 0), Vec3(0.02, 0, 0), Vec3(0, 0.02, 0), Vec3(0.001, 0.001, 0)};
  const std::vector<Triangle> triangles = {{0, 1, 2}, {0, 1, 3}, {0, 3, 2}};
  const std::vector<std::uint16_t> labels = {1, 1, 0};
  Atlas atlas(0.0003);
  atlas.fill({rest, triangles, labels}, {&five()});
  EXPECT_EQ(atlas.n_coarse(), 1u); // half a square of 20 mm, which would need 67 parts
  EXPECT_EQ(atlas.parts()[0], Atlas::max_parts);
  EXPECT_EQ(atlas.parts()[1], 48); // a sliver: 20 mm over the square root of 2
}

} // namespace
} // namespace kerf::texture::atlas_test
