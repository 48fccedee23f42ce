#include "visibility/disk.h"

#include "base/error.h"
#include "geometry/box_tree.h"
#include "tests/visibility/cases.h"

#include <gtest/gtest.h>

#include <numbers>

namespace kerf::visibility::disk_test {
namespace {

TEST(MaskShape, HasTheTexelsOfADisk) {
  for (const int n : {4, 8, 15, 32}) {
    const MaskShape shape(n, 0.5);
    EXPECT_NEAR(shape.n_texels(), std::numbers::pi * n * n / 4, n) << n;
    for (int y = 0; y < n; ++y) {
      EXPECT_EQ(shape.disk()[y], shape.disk()[n - 1 - y]);
      EXPECT_EQ(std::uint64_t(shape.disk()[y]) >> n, 0u);
    }
    for (int y = n; y < MaskShape::max_resolution; ++y)
      EXPECT_EQ(shape.disk()[y], 0u);
  }
}

TEST(MaskShape, RefusesWhatIsNoDisk) {
  for (const int n : {-1, 0, 3, 33, 64})
    EXPECT_THROW(MaskShape(n, 0.5), ParameterError) << n;
  for (const double radius :
       {0., -0.5, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    EXPECT_THROW(MaskShape(32, radius), ParameterError) << radius;
  try {
    MaskShape(32, -0.5);
    ADD_FAILURE();
  } catch (const ParameterError& e) {
    EXPECT_EQ(e.complaint().path, "Disk radius [1]");
    EXPECT_EQ(e.complaint().value, "-0.5");
  }
}

TEST(Disk, StandsHalfwayAtARightAngle) {
  Random random(1);
  for (const double radius : {0.25, 0.5, 1.}) {
    const MaskShape shape(32, radius);
    const Vec3 a = random.vector(), b = random.vector();
    const Disk disk = make_disk({a, b, 1}, shape);
    const double distance = (b - a).norm();
    EXPECT_NEAR((disk.middle - (a + b) / 2).norm(), 0, 1e-15);
    EXPECT_NEAR(disk.to_z.dot(a - disk.middle), -1, 1e-14);
    EXPECT_NEAR(disk.to_z.dot(b - disk.middle), 1, 1e-14);
    // Sixteen texels to the border of the disk.
    EXPECT_NEAR(disk.to_x.norm() * radius * distance, 16, 1e-12);
    EXPECT_NEAR(disk.to_y.norm() * radius * distance, 16, 1e-12);
    EXPECT_NEAR(disk.to_x.dot(disk.to_y) + disk.to_x.dot(disk.to_z) + disk.to_y.dot(disk.to_z), 0, 1e-10);
    const Vec3 corner = texel_middle(disk, shape, 0, 31) - disk.middle;
    EXPECT_NEAR(disk.to_x.dot(corner), -15.5, 1e-12);
    EXPECT_NEAR(disk.to_y.dot(corner), 15.5, 1e-12);
    EXPECT_NEAR(disk.to_z.dot(corner), 0, 1e-14);
  }
}

TEST(Disk, ItsBoxIsTheSmallestAroundItsLines) {
  Random random(2);
  const MaskShape shape(32, 0.7);
  for (int i = 0; i < 50; ++i) {
    const Pair pair{random.vector(), random.vector(), 1};
    const Disk disk = make_disk(pair, shape);
    Points points = {pair.a, pair.b};
    const double radius = 0.7 * (pair.b - pair.a).norm();
    for (int k = 0; k < 1000; ++k) {
      const double angle = 2 * std::numbers::pi * k / 1000;
      points.push_back(disk.middle +
                       radius * (std::cos(angle) * disk.to_x.normalized() + std::sin(angle) * disk.to_y.normalized()));
    }
    const Box box = box_of_lines(pair, shape), expected = geometry::box_around(points);
    EXPECT_NEAR((box.lower - expected.lower).norm() + (box.upper - expected.upper).norm(), 0, 1e-4);
  }
}

TEST(Disk, LooksOnlyPastFacesThatOccludeNothing) {
  int n_passed = 0, n_kept = 0;
  for (const double spread : {0.3, 0.8}) {
    const Disks disks = random_disks(3, 300, 4, spread, 0.3);
    for (std::size_t i = 0; i < disks.pairs.size(); ++i)
      for (const Face& face : disks.faces_of(i)) {
        const Disk disk = make_disk(disks.pairs[i], disks.shape);
        const bool kept = may_occlude(disk, disks.shape, face, 0) || may_occlude(disk, disks.shape, face, 1);
        (kept ? n_kept : n_passed) += 1;
        if (!kept) {
          EXPECT_EQ(count(ray_tested(disks.pairs[i], disks.shape, {&face, 1})), 0);
        }
      }
  }
  EXPECT_GT(n_passed, 300);
  EXPECT_GT(n_kept, 300);
}

} // namespace
} // namespace kerf::visibility::disk_test
