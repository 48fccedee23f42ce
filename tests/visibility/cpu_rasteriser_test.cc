#include "visibility/cpu_rasteriser.h"

#include "base/parallel.h"
#include "tests/visibility/cases.h"

#include <gtest/gtest.h>

#include <numbers>

namespace kerf::visibility::cpu_rasteriser_test {
namespace {

std::vector<std::uint32_t> rasterised(const Pair& pair, const MaskShape& shape, const std::vector<Face>& faces) {
  std::vector<std::uint32_t> mask(shape.resolution(), 0), indices;
  for (std::uint32_t i = 0; i < faces.size(); ++i)
    indices.push_back(i);
  const DiskUpdate update{make_disk(pair, shape), indices, mask.data()};
  CpuRasteriser().occlude(shape, faces, {&update, 1});
  return mask;
}

struct Agreement {
  std::size_t n_texels = 0, n_occluded = 0, n_different = 0;
};

Agreement compare(Disks disks) {
  CpuRasteriser().occlude(disks.shape, disks.faces, disks.updates());
  Agreement result;
  for (std::size_t i = 0; i < disks.pairs.size(); ++i) {
    const auto expected = ray_tested(disks.pairs[i], disks.shape, disks.faces_of(i));
    result.n_texels += disks.shape.resolution() * disks.shape.resolution();
    result.n_occluded += count(expected);
    result.n_different += n_different(expected, disks.mask_of(i));
  }
  return result;
}

TEST(CpuRasteriser, IsTheRayTestButForOneTexelInAMillion) {
  Agreement sum;
  unsigned seed = 10;
  for (const int n_faces : {1, 2, 8, 20})
    for (const double spread : {0.1, 0.5})
      for (const double size : {0.05, 0.3, 1., 10.}) {
        const Agreement found = compare(random_disks(++seed, 150, n_faces, spread, size));
        sum.n_texels += found.n_texels;
        sum.n_occluded += found.n_occluded;
        sum.n_different += found.n_different;
      }
  RecordProperty("n_different", static_cast<int>(sum.n_different));
  EXPECT_GT(sum.n_texels, 4'000'000u);
  EXPECT_GT(sum.n_occluded, sum.n_texels / 10);
  EXPECT_LT(sum.n_occluded, sum.n_texels / 2);
  EXPECT_LE(sum.n_different, 1e-6 * static_cast<double>(sum.n_texels));
}

TEST(CpuRasteriser, IsTheRayTestForOtherDisks) {
  for (const int resolution : {4, 9, 16, 31})
    for (const double radius : {0.1, 1.5}) {
      const Agreement found = compare(random_disks(7, 200, 3, 0.3, 0.5, {resolution, radius}));
      EXPECT_LE(found.n_different, 1u) << resolution << ' ' << radius;
      EXPECT_GT(found.n_occluded, 0u);
    }
}

/// Fans around a point: all triangles share edges, so a ray that slips through two of them shows up as an open texel.
TEST(CpuRasteriser, HasNoHolesAlongSeams) {
  Random random(3);
  const MaskShape shape(32, 0.5);
  for (int i = 0; i < 2000; ++i) {
    const Pair pair{random.vector(), random.vector(), 1};
    const Disk disk = make_disk(pair, shape);
    const double distance = (pair.b - pair.a).norm();
    const Vec3 u = disk.to_x.normalized(), v = disk.to_y.normalized(), n = disk.to_z.normalized();
    const Vec3 hub = disk.middle + 0.3 * distance * (random.number() * u + random.number() * v) -
                     (0.1 + 0.3 * random.number()) * distance * n;
    std::vector<Face> fan;
    const auto rim = [&](const int k) {
      const double angle = 2 * std::numbers::pi * (k % 7) / 7 + 0.1;
      return Vec3(hub + 3 * distance * (std::cos(angle) * u + std::sin(angle) * v));
    };
    for (int k = 0; k < 7; ++k)
      fan.push_back({hub, rim(k), rim(k + 1)});
    EXPECT_EQ(count(rasterised(pair, shape, fan)), shape.n_texels()) << i;
  }
}

/// A half plane that ends at a chord at `at` radii from the middle leaves a circular segment, whether it stands in the
/// disk or, smaller by perspective, halfway to a point.
TEST(CpuRasteriser, HalfPlaneCoversACircularSegment) {
  const MaskShape shape(32, 0.5);
  Random random(4);
  double largest = 0;
  for (const double at : {-0.9, -0.5, -0.1, 0., 0.3, 0.6, 0.95})
    for (const double depth : {0., 0.5, -0.5})
      for (int i = 0; i < 20; ++i) {
        const Vec3 a = random.vector();
        const Pair pair{a, a + 0.1 * random.direction(), 1};
        const Disk disk = make_disk(pair, shape);
        const double angle = 2 * std::numbers::pi * random.number(), radius = 0.05, shrunk = 1 - std::abs(depth);
        const Vec3 u = disk.to_x.normalized(), v = disk.to_y.normalized();
        const Vec3 across = std::cos(angle) * u + std::sin(angle) * v,
                   along = std::cos(angle) * v - std::sin(angle) * u;
        const Vec3 chord = disk.middle + 0.05 * depth * disk.to_z.normalized() + shrunk * at * radius * across;
        const std::vector<Face> plane = {{chord - along, chord + along, chord + along + across},
                                         {chord - along, chord + along + across, chord - along + across}};
        const double covered = count(rasterised(pair, shape, plane)) / double(shape.n_texels());
        const double segment = (std::acos(at) - at * std::sqrt(1 - at * at)) / std::numbers::pi;
        // The chord crosses about one texel in each row or column that it passes; half of them go either way.
        const double n_edge_texels = 32 * std::sqrt(1 - at * at);
        EXPECT_NEAR(covered, segment, (1 + 0.5 * n_edge_texels) / shape.n_texels()) << at << ' ' << depth;
        largest = std::max(largest, std::abs(covered - segment));
      }
  EXPECT_LT(largest, 0.012); // most edge texels cancel each other
}

TEST(CpuRasteriser, FaceInThePlaneOfTheDiskCounts) {
  const MaskShape shape(32, 0.5);
  const Pair pair{{0, 0, -1}, {0, 0, 1}, 1};
  EXPECT_EQ(count(rasterised(pair, shape, {{Vec3(-9, -9, 0), Vec3(9, -9, 0), Vec3(0, 9, 0)}})), shape.n_texels());
}

TEST(CpuRasteriser, NothingIsOccludedByFacesWithoutAreaOrSeenEdgeOn) {
  const MaskShape shape(32, 0.5);
  const Pair pair{{0, 0, -1}, {0, 0, 1}, 1};
  const Vec3 p(0.1, 0.2, 0.3), q(-0.3, 0.1, -0.2), beyond(5, 5, 5), more(6, 5, 5), most(5, 6, 6);
  EXPECT_EQ(count(rasterised(pair, shape, {{p, p, p}})), 0);
  EXPECT_EQ(count(rasterised(pair, shape, {{p, q, q}})), 0);
  EXPECT_EQ(count(rasterised(pair, shape, {{p, q, 0.5 * p + 0.5 * q}})), 0);
  EXPECT_EQ(count(rasterised(pair, shape, {{Vec3(0, -9, -9), Vec3(0, 9, -9), Vec3(0, 0, 9)}})), 0);
  EXPECT_EQ(count(rasterised(pair, shape, {{beyond, more, most}})), 0);
  EXPECT_EQ(count(rasterised(pair, shape, {})), 0);
}

TEST(CpuRasteriser, FacesOnlyAddWhateverTheirOrder) {
  Disks disks = random_disks(5, 100, 6, 0.3, 0.4);
  const MaskShape& shape = disks.shape;
  for (std::size_t i = 0; i < disks.pairs.size(); ++i) {
    const std::span<const Face> all = disks.faces_of(i);
    std::vector<std::uint32_t> sum(shape.resolution(), 0);
    int before = 0;
    for (auto face = all.rbegin(); face != all.rend(); ++face) {
      const auto alone = rasterised(disks.pairs[i], shape, {*face});
      for (std::size_t y = 0; y < sum.size(); ++y)
        sum[y] |= alone[y];
      EXPECT_GE(count(sum), before);
      before = count(sum);
    }
    EXPECT_EQ(sum, rasterised(disks.pairs[i], shape, {all.begin(), all.end()}));
  }
}

TEST(CpuRasteriser, SetTexelsStaySet) {
  Disks disks = random_disks(6, 10, 3, 0.3, 0.4);
  std::fill(disks.masks.begin(), disks.masks.end(), 0x00010000u);
  CpuRasteriser().occlude(disks.shape, disks.faces, disks.updates());
  for (const std::uint32_t row : disks.masks)
    EXPECT_NE(row & 0x00010000u, 0u);
}

TEST(CpuRasteriser, TwoThreadsGiveTheSameBits) {
  Disks one = random_disks(8, 3000, 5, 0.3, 0.4), two = one;
  const int n = n_threads();
  set_n_threads(1);
  CpuRasteriser().occlude(one.shape, one.faces, one.updates());
  set_n_threads(2);
  CpuRasteriser().occlude(two.shape, two.faces, two.updates());
  set_n_threads(n);
  EXPECT_EQ(one.masks, two.masks);
}

} // namespace
} // namespace kerf::visibility::cpu_rasteriser_test
