#include "tests/texture/probes.h"

#include <gtest/gtest.h>

namespace kerf::texture::detail_test {
namespace {

TEST(Detail, PutsBackWhatBlendingLoses) {
  // Noise is nobody's deformation: only its histogram can be kept.
  const Solid noise = [](const Vec3& p) {
    const auto hash = [](const double x) { return x - std::floor(x); };
    return image::Rgb::Constant(
      static_cast<float>(0.3 + 0.4 * hash(std::sin(p.dot(Vec3(12989.8, 78233.1, 37719.3))) * 43758.5)));
  };
  const Interior inside(axis_exemplars(noise, 3, 120), ball(3), {});
  const Detail detail(inside);
  const double pixel = inside.pixel();
  const auto spread = [&](const Detail* used, const Vec3& x, const Vec3& y) {
    const Patch patch{Vec3(-0.02, -0.02, 0.013), pixel * x, pixel * y, 40, 40};
    double sum = 0, squares = 0;
    const auto painted = paint(inside, patch, used);
    for (const Eigen::Array4f& c : painted.values) {
      sum += c[3] / 1600;
      squares += c[3] * c[3] / 1600;
    }
    return std::sqrt(squares - sum * sum);
  };
  const double exact = 0.4 / std::sqrt(12.0), off = spread(nullptr, Vec3::UnitX(), Vec3::UnitY());
  const double on = spread(&detail, Vec3::UnitX(), Vec3::UnitY());
  EXPECT_LT(off, 0.8 * exact);
  EXPECT_NEAR(on, exact, 0.15 * exact);
}

TEST(Detail, FollowsTheOrientationOfTheSurface) {
  // Fine layers across z: a window on a plane z = constant sees one of them, a window on an upright plane many.
  const Solid layers = [](const Vec3& p) {
    return image::Rgb::Constant(
      static_cast<float>(0.5 + 0.3 * std::sin(p[2] / 0.0005) + 0.1 * std::sin(p[0] / 0.0004)));
  };
  const Interior inside(axis_exemplars(layers, 3, 160), ball(3), {});
  const Detail detail(inside);
  const double pixel = inside.pixel();
  const auto at = [&](const Vec3& p, const Vec3& x, const Vec3& y, const Detail* used) {
    return paint(inside, {p - 3 * pixel * (x + y), pixel * x, pixel * y, 7, 7}, used)(3, 3);
  };
  const Vec3 x = Vec3::UnitX(), y = Vec3::UnitY(), z = Vec3::UnitZ();
  double without = 0, turned = 0, same_plane = 0;
  const Points points = points_inside(200, 13, 0.03);
  for (const Vec3& p : points) {
    without = std::max(without, difference(at(p, x, y, nullptr), at(p, x, z, nullptr)));
    turned += difference(at(p, x, y, &detail), at(p, x, z, &detail)) / 200;
    same_plane = std::max(same_plane, difference(at(p, x, y, &detail), at(p, -y, x, &detail)));
  }
  std::printf(
    "the same points: without %.1e; with small features, plane turned %.3f on average, turned in itself %.1e\n",
    without, turned, same_plane);
  EXPECT_LT(without, 1e-5);
  EXPECT_GT(turned, 0.03);
  EXPECT_LT(same_plane, 1e-5); // a square window turned by a right angle
}

} // namespace
} // namespace kerf::texture::detail_test
