#include "visibility/gl_rasteriser.h"

#include "tests/visibility/cases.h"
#include "visibility/cpu_rasteriser.h"

#include <gtest/gtest.h>

#include <cstdio>

namespace kerf::visibility::gl_rasteriser_test {
namespace {

/// More disks than one image holds, of several shapes and sizes of faces.
TEST(GlRasteriser, AgreesWithTheProcessorButForOneTexelInAThousand) {
  GlRasteriser gl;
  std::size_t n = 0, n_wrong = 0, n_occluded = 0;
  unsigned seed = 20;
  for (const MaskShape& shape : {MaskShape(32, 0.5), MaskShape(16, 0.8), MaskShape(11, 0.5)})
    for (const int n_faces : {1, 2, 8, 20})
      for (const double size : {0.1, 0.5, 3.}) {
        Disks by_gl = random_disks(++seed, n_faces == 2 ? 1500 : 200, n_faces, 0.4, size, shape), by_cpu = by_gl;
        gl.occlude(shape, by_gl.faces, by_gl.updates());
        CpuRasteriser().occlude(shape, by_cpu.faces, by_cpu.updates());
        n += by_gl.pairs.size() * shape.resolution() * shape.resolution();
        n_wrong += n_different(by_gl.masks, by_cpu.masks);
        n_occluded += count(by_cpu.masks);
      }
  std::printf("OpenGL differs in %zu of %zu texels: %.2g\n", n_wrong, n, double(n_wrong) / double(n));
  EXPECT_GT(n_occluded, n / 10);
  EXPECT_LE(n_wrong, 1e-3 * static_cast<double>(n));
}

TEST(GlRasteriser, AddsToWhatIsOccludedAlready) {
  GlRasteriser gl;
  Disks at_once = random_disks(1, 50, 6, 0.3, 0.4), in_turn = at_once;
  gl.occlude(at_once.shape, at_once.faces, at_once.updates());
  for (std::size_t k = 0; k < 6; ++k) {
    std::vector<DiskUpdate> updates = in_turn.updates();
    for (DiskUpdate& update : updates)
      update.faces = update.faces.subspan(k, 1);
    const int before = count(in_turn.masks);
    gl.occlude(in_turn.shape, in_turn.faces, updates);
    EXPECT_GE(count(in_turn.masks), before);
    EXPECT_EQ(gl.n_written(), static_cast<std::size_t>(count(in_turn.masks) - before));
  }
  EXPECT_EQ(at_once.masks, in_turn.masks);
}

/// A face over the whole disk closes it and no texel of its neighbours in the image.
TEST(GlRasteriser, StaysInsideItsTile) {
  GlRasteriser gl;
  Disks disks = random_disks(2, 9, 1, 0, 1e-9);
  const Disk disk = make_disk(disks.pairs[4], disks.shape);
  const Vec3 u = disk.to_x.normalized(), v = disk.to_y.normalized(),
             m = disk.middle - 0.3 / disk.to_z.squaredNorm() * disk.to_z;
  disks.faces[4] = {m - 9 * u - 9 * v, m + 9 * u - 9 * v, m + 9 * v};
  gl.occlude(disks.shape, disks.faces, disks.updates());
  EXPECT_EQ(count(disks.mask_of(4)), disks.shape.n_texels());
  EXPECT_EQ(count(disks.masks), disks.shape.n_texels());
}

TEST(GlRasteriser, TakesTurnsWithAnother) {
  Disks first = random_disks(3, 20, 3, 0.3, 0.4), second = first;
  GlRasteriser a;
  {
    GlRasteriser b;
    a.occlude(first.shape, first.faces, first.updates());
    b.occlude(second.shape, second.faces, second.updates());
  }
  const std::vector<std::uint32_t> before = first.masks;
  a.occlude(first.shape, first.faces, first.updates());
  EXPECT_EQ(first.masks, second.masks);
  EXPECT_EQ(first.masks, before);
}

TEST(GlRasteriser, LeavesWithoutTakingWhatIsOfAnother) {
  Disks first = random_disks(4, 20, 3, 0.3, 0.4), second = first;
  auto a = std::make_unique<GlRasteriser>();
  a->occlude(first.shape, first.faces, first.updates());
  GlRasteriser b; // its objects have the same numbers in a context of its own
  a = nullptr;
  b.occlude(second.shape, second.faces, second.updates());
  EXPECT_GT(count(first.masks), 0);
  EXPECT_EQ(first.masks, second.masks);
}

} // namespace
} // namespace kerf::visibility::gl_rasteriser_test
