// Points inside closed meshes, against a closed form, and on the skin.

#include "geometry/inside.h"

#include "geometry/solid.h"
#include "tests/support/checkout.h"

#include <gtest/gtest.h>

#include <random>

namespace kerf::geometry::inside_test {
namespace {

TriangleMesh mesh_of(const std::string& name) {
  const std::string path = support::checkout() + "/params/meshes/" + name;
  return require_solid(read_mesh(path, 1), path);
}

TEST(Inside, ACubeHoldsWhatIsBetweenItsFaces) {
  const TriangleMesh mesh = mesh_of("cube.off");
  const Box box = bounding_box(mesh);
  const Inside inside(mesh);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> part(-0.2, 1.2);
  int n_inside = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 p = box.lower + Vec3(part(random), part(random), part(random)).cwiseProduct(box.upper - box.lower);
    EXPECT_EQ(inside.contains(p), box.contains(p)) << p.transpose();
    n_inside += inside.contains(p) ? 1 : 0;
  }
  EXPECT_GT(n_inside, 400);
  EXPECT_LT(n_inside, 1600);
}

/// Above a vertex, an edge or a diagonal of the mesh, where a segment up meets several triangles at once.
TEST(Inside, PointsBelowEdgesAndVerticesCountOnce) {
  const TriangleMesh mesh = mesh_of("cube.off");
  const Box box = bounding_box(mesh);
  const Inside inside(mesh);
  const Vec3 middle = 0.5 * (box.lower + box.upper), half = 0.5 * (box.upper - box.lower);
  for (const double x : {-0.5, 0.0, 0.5})
    for (const double y : {-0.5, 0.0, 0.5}) {
      EXPECT_TRUE(inside.contains(middle + Vec3(x, y, 0).cwiseProduct(half)));
      EXPECT_FALSE(inside.contains(middle + Vec3(x, y, -1.5).cwiseProduct(half)));
      EXPECT_FALSE(inside.contains(middle + Vec3(x, y, 1.5).cwiseProduct(half)));
    }
}

/// The part of random points of the bounding box that is inside is the part of its volume, to three deviations.
TEST(Inside, VolumeByCountingAgrees) {
  for (const std::string name : {"pear.off", "apple.off"}) {
    const TriangleMesh mesh = mesh_of(name);
    const Box box = bounding_box(mesh);
    const Vec3 size = box.upper - box.lower;
    const Inside inside(mesh);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> part(0, 1);
    constexpr int n = 20000;
    int n_inside = 0;
    for (int i = 0; i < n; ++i)
      n_inside +=
        inside.contains(box.lower + Vec3(part(random), part(random), part(random)).cwiseProduct(size)) ? 1 : 0;
    const double expected = volume(mesh) / size.prod();
    EXPECT_NEAR(static_cast<double>(n_inside) / n, expected, 3 * std::sqrt(expected * (1 - expected) / n)) << name;
  }
}

} // namespace
} // namespace kerf::geometry::inside_test
