// Outlines of masks, and fits of sections that rays from their middles would leave more than once.

#include "texture/outline.h"
#include "base/error.h"
#include "image/file.h"
#include "image/filters.h"
#include "tests/support/checkout.h"
#include "tests/texture/solids.h"
#include "tests/texture/stored.h"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::texture::outline_test {
namespace {

using image::Grey;

template <class IsIn>
Grey mask_where(const int width, const int height, const IsIn& is_in) {
  Grey mask(width, height, 0);
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c)
      mask(c, r) = is_in(Vec2(c, r)) ? 1.0f : 0.0f;
  return mask;
}

Grey disk() {
  return mask_where(240, 240, [](const Vec2& p) { return (p - Vec2(120, 120)).norm() < 90; });
}

/// A disk without a smaller one.
Grey crescent() {
  return mask_where(240, 240, [](const Vec2& p) {
    const Vec2 q = p - Vec2(120, 120);
    return q.norm() < 90 && (q - Vec2(70, 0)).norm() > 70;
  });
}

/// A ring that is open on one side, by an angle to each side [rad].
Grey letter_c(const double open) {
  return mask_where(240, 240, [=](const Vec2& p) {
    const Vec2 q = p - Vec2(120, 120);
    return q.norm() < 90 && q.norm() > 45 && std::abs(std::atan2(q[1], q[0])) > open;
  });
}

/// A disk with a bay from the right to its middle.
Grey with_bay(const double width) {
  return mask_where(240, 240, [=](const Vec2& p) {
    const Vec2 q = p - Vec2(120, 120);
    return q.norm() < 90 && !(q[0] > 0 && std::abs(q[1]) < 0.5 * width);
  });
}

/// How a picture of one mask is drawn to a section of another, both on pixels of one lattice.
struct Drawn {
  warp::LatticeMap map;
  warp::Gap gap; ///< the larger of both ways [pixels]
};

Drawn drawn(const Grey& section, const Grey& picture) {
  const Outlines outlines = outlines_of(section, picture);
  const warp::LatticeMap map = fitted(outlines, {});
  return {map, gap_after(map, outlines)};
}

TEST(Outline, IsWhereADiskEnds) {
  const warp::Curve outline = outline_of(disk());
  for (const Vec2& p : outline)
    EXPECT_NEAR((p - Vec2(120, 120)).norm(), 90, 0.75);
  EXPECT_NEAR(std::abs(warp::area_of(outline)), M_PI * 90 * 90, 0.01 * M_PI * 90 * 90);
}

TEST(Outline, ClosesNarrowBaysAndKeepsWideOnes) {
  // A twentieth of 180 pixels is 9.
  EXPECT_GT(std::abs(warp::area_of(outlines_of(with_bay(6), disk()).section)), 0.99 * M_PI * 90 * 90);
  EXPECT_LT(std::abs(warp::area_of(outlines_of(with_bay(24), disk()).section)), 0.94 * M_PI * 90 * 90);
}

TEST(Outline, BridgesGapsThatPartASection) {
  const auto halves = [](const double gap) {
    return mask_where(
      240, 240, [=](const Vec2& p) { return (p - Vec2(120, 120)).norm() < 90 && std::abs(p[0] - 120) > 0.5 * gap; });
  };
  for (const double gap : {6.0, 16.0})
    EXPECT_GT(std::abs(warp::area_of(outlines_of(disk(), halves(gap)).picture)), 0.95 * M_PI * 90 * 90) << gap;
  EXPECT_LT(std::abs(warp::area_of(outlines_of(disk(), halves(80)).picture)), 0.5 * M_PI * 90 * 90);
}

TEST(Outline, FitsShapesThatAreNoStars) {
  const std::vector<Grey> shapes = {disk(), crescent(), letter_c(0.5), letter_c(0.7), with_bay(6), with_bay(24)};
  for (std::size_t i = 0; i < shapes.size(); ++i)
    for (const std::size_t k : {i, (i + 1) % shapes.size()}) {
      if (i != k && std::min(i, k) == 0)
        continue; // a disk is no crescent
      const Drawn there = drawn(shapes[i], shapes[k]);
      EXPECT_LT(there.gap.mean, 2) << i << " " << k;
      EXPECT_LT(there.gap.largest, 4) << i << " " << k;
      EXPECT_GT(warp::smallest_determinant(there.map), 0) << i << " " << k;
    }
}

TEST(Outline, FindsAffineImages) {
  // What is stretched along any two axes and moved finds itself, inside, too.
  Mat2 linear;
  linear << 0.9, 0.08, 0.08, 1.1; // no rotation: a disk could not tell
  const Vec2 middle(120, 120), shift(6, -4);
  for (const Grey& picture : {disk(), crescent(), letter_c(0.6), with_bay(24)}) {
    const auto there = [&](const Vec2& p) { return Vec2(middle + shift + linear * (p - middle)); };
    const Grey section = mask_where(240, 240, [&](const Vec2& p) {
      const Vec2 q = there(p);
      return q.minCoeff() >= 0 && q.maxCoeff() <= 239 &&
             image::sample(picture, static_cast<float>(q[0]), static_cast<float>(q[1])) > 0.5f;
    });
    const Drawn found = drawn(section, picture);
    EXPECT_LT(found.gap.largest, 1.5);
    double sum = 0, n = 0;
    for (int r = 0; r < 240; r += 4)
      for (int c = 0; c < 240; c += 4)
        if (section(c, r) > 0.5f) {
          sum += (found.map(Vec2(c, r)) - there(Vec2(c, r))).norm();
          ++n;
        }
    EXPECT_LT(sum / n, 1); // of 180 pixels
  }
}

struct Case {
  std::string picture, body;
  Vec3 origin, column, row;
};

geometry::TriangleMesh body_of(const Case& c) {
  return geometry::read_mesh(support::checkout() + "/params/meshes/" + c.body + ".off", c.body == "apple" ? 1 : 1e-3);
}

/// A picture of params/sections.
Exemplar exemplar_of(const Case& c) {
  return {c.picture, image::read_image(support::checkout() + "/params/sections/" + c.picture + ".png"),
          c.picture[0] == 'b' ? Background::black : Background::alpha, SectionPlane(c.origin, c.column, c.row),
          Fit::rigid};
}

/// Fitted to a body of params/meshes.
Chart fitted(const Exemplar& exemplar, const geometry::TriangleMesh& body) {
  std::optional<warp::LatticeMap> used;
  Chart chart = make_chart(exemplar, body, {}, used);
  EXPECT_GT(warp::smallest_determinant(*used), 0) << exemplar.name;
  return chart;
}

TEST(Outline, FitsBrainsAndFruitToTheLiverTheBrainAndTheApple) {
  for (const Case& c : std::vector<Case>{
         {"brain/axial_z75", "liver_25k", {0.05, 0, 0.075}, {0.0007, 0, 0}, {0, 0.0005, 0}},
         {"brain/axial_z75", "liver_25k", {0.05, 0, 0.09}, {0.0007, 0, 0}, {0, 0.0005, 0}},
         {"brain/sagittal_x60", "liver_25k", {0.1, 0, 0}, {0, 0.0005, 0}, {0, 0, 0.0005}},
         {"brain/coronal_y140", "liver_25k", {0.05, 0.08, 0}, {0.0007, 0, 0}, {0, 0, 0.0005}},
         {"brain/coronal_y140", "liver_25k", {0.05, 0.065, 0}, {0.0007, 0, 0}, {0, 0, 0.0005}},
         {"fruit/kiwi_whole", "liver_25k", {0.05, 0.08, 0}, {0.0005, 0, 0}, {0, 0, 0.0005}},
         {"brain/axial_z35", "brain_40k", {0.015, 0.018, 0.035}, {0.0005, 0, 0}, {0, 0.0005, 0}},
         {"brain/sagittal_x60", "brain_40k", {0.06, 0.018, 0.0015}, {0, 0.0005, 0}, {0, 0, 0.0005}},
         {"brain/coronal_y140", "brain_40k", {0.015, 0.13, 0.0015}, {0.0005, 0, 0}, {0, 0, 0.0005}},
         {"fruit/lemon", "apple", {-0.0376, 0.041, -0.0418}, {0.0002, 0, 0}, {0, 0, 0.0002}},
         {"fruit/orange_whole", "apple", {-0.02632, 0.014, -0.02926}, {0.00014, 0, 0}, {0, 0, 0.00014}}}) {
    const Chart chart = fitted(exemplar_of(c), body_of(c));
    std::printf("%s in %s: %.2f on average, %.2f at most\n", c.picture.c_str(), c.body.c_str(), chart.fit_error.mean,
                chart.fit_error.largest);
    EXPECT_LT(chart.fit_error.mean, 0.5) << c.picture << " " << c.body << " " << c.origin.transpose();
    EXPECT_LT(chart.fit_error.largest, 4) << c.picture << " " << c.body << " " << c.origin.transpose();
  }
}

/// Mean difference of what two charts show where the first lies in the body, of 255.
double apart(const Chart& a, const Chart& b) {
  double sum = 0, n = 0;
  for (int r = 0; r < a.inside.height; ++r)
    for (int c = 0; c < a.inside.width; ++c)
      if (a.inside(c, r) > 0.5f) {
        const Vec2 p = b.plane.to_pixels(b.plane.local(a.plane.point(a.plane.to_local(Vec2(c, r)))));
        const auto there = image::sample_spline(b.spline, static_cast<float>(p[0]), static_cast<float>(p[1]));
        sum += 255 * std::abs(there[3] - a.colours(c, r)[3]);
        ++n;
      }
  return sum / n;
}

TEST(Outline, NoStarIsDrawnNearlyTheSameHoweverItIsStored) {
  struct Stored {
    Case c;
    double by_right_angles, between; ///< mean difference allowed, of 255
  };
  // Measured: .02 and .7; .02 and 1.9, where pictures as they are, not fitted, differ by .3 and 2.1.
  for (const auto& [c, by_right_angles, between] : std::vector<Stored>{
         {{"brain/axial_z35", "brain_40k", {0.015, 0.018, 0.035}, {0.0005, 0, 0}, {0, 0.0005, 0}}, 0.1, 1.3},
         {{"brain/coronal_y140", "liver_25k", {0.05, 0.08, 0}, {0.0006, 0, 0}, {0, 0, 0.0006}}, 0.1, 3}}) {
    const geometry::TriangleMesh body = body_of(c);
    Exemplar exemplar = exemplar_of(c);
    const Grey mask = mask_of(exemplar.picture, exemplar.background);
    exemplar.picture.colours = image::blurred(image::filled(exemplar.picture.colours, mask), 1.5);
    exemplar.picture.alpha = mask;
    exemplar.background = Background::alpha;
    const Chart before = fitted(exemplar, body);
    double at_right_angles = 0;
    for (const auto& stored : {turned(exemplar), mirrored(exemplar), turned(turned(exemplar))})
      at_right_angles = std::max(at_right_angles, apart(before, fitted(stored, body)));
    const double turned_between = apart(before, fitted(turned_by(exemplar, 0.5), body));
    std::printf("%s in %s: by right angles %.2f, by half a radian %.2f\n", c.picture.c_str(), c.body.c_str(),
                at_right_angles, turned_between);
    EXPECT_LT(at_right_angles, by_right_angles) << c.picture;
    EXPECT_LT(turned_between, between) << c.picture;
  }
}

TEST(Outline, WhatIsSymmetricIsDrawnSymmetrically) {
  // A bent bean with stripes in the section of a body that is bent more; no ray from its middle tells where it ends.
  geometry::TriangleMesh body = ball(4);
  for (Vec3& v : body.vertices)
    v = Vec3(v[0], 0.4 * v[1] + 20 * v[0] * v[0], 0.5 * v[2]);
  const Vec3 x(0.0005, 0, 0), y(0, 0.0005, 0);
  const auto bent = [](const Vec2& p) {
    return Vec2((p[0] - 120) / 100, (p[1] - 60 - 0.006 * std::pow(p[0] - 120, 2)) / 35);
  };
  Exemplar exemplar{"bean",
                    {image::Colours(240, 240, image::Rgb::Zero()), {}},
                    Background::alpha,
                    SectionPlane(-120 * x - 60 * y, x, y),
                    Fit::rigid};
  exemplar.picture.alpha = mask_where(240, 240, [&](const Vec2& p) { return bent(p).norm() < 1; });
  for (int r = 0; r < 240; ++r)
    for (int c = 0; c < 240; ++c)
      exemplar.picture.colours(c, r) = image::Rgb::Constant(
        static_cast<float>(0.5 + 0.4 * std::cos(0.1 * (c - 120)) * std::cos(4 * bent(Vec2(c, r))[1])));
  for (const Exemplar& stored : {exemplar, turned_by(exemplar, 0.5)}) {
    const Chart chart = fitted(stored, body);
    double sum = 0, n = 0;
    for (int r = 0; r < chart.inside.height; ++r)
      for (int c = 0; c < chart.inside.width; ++c)
        if (chart.inside(c, r) > 0.5f) {
          sum += 255 * std::abs(chart.colours(c, r)[3] - chart.colours(chart.inside.width - 1 - c, r)[3]);
          ++n;
        }
    std::printf("mirrored: %.3f of 255 on average\n", sum / n);
    EXPECT_LT(sum / n, 2.5); // .3, and 1.8 with pixels between pixels
  }
}

} // namespace
} // namespace kerf::texture::outline_test
