// The scenes that say what is inside, with their photographs.

#include "scene/compose_interior.h"
#include "tests/support/checkout.h"
#include "tests/texture/probes.h"

#include <gtest/gtest.h>

namespace kerf::scene::inside_scenes_test {
namespace {

LookedInto look_into(const std::string& scene) {
  return compose_inside(read_scene_text(support::checkout() + "/params/" + scene, {}));
}

constexpr std::array scenes = {"brain.prm", "thesis/fig_3_28.prm", "thesis/fig_3_29.prm", "thesis/fig_3_30.prm",
                               "thesis/fig_3_32.prm"};

/// The largest change of a colour from one side of an exemplar's plane to the other, 2e-10 m apart.
double jump_across_planes(const texture::Interior& inside) {
  double jump = 0;
  for (const texture::Chart& chart : inside.charts())
    for (int r = 0; r < chart.inside.height; r += 5)
      for (int c = 0; c < chart.inside.width; c += 5)
        if (chart.inside(c, r) > 0.5f) {
          const Vec3 p = chart.plane.point(chart.plane.to_local(Vec2(c, r))), step = 1e-10 * chart.plane.normal();
          jump = std::max(jump, texture::difference(inside.colour(p + step), inside.colour(p - step)));
        }
  return jump;
}

/// The largest jump on straight ways between points of the exemplars.
double jump_on_ways(const texture::Interior& inside, const geometry::TriangleMesh& body) {
  const geometry::Inside is_inside(body);
  std::mt19937 random(3);
  const auto end = [&] {
    const texture::Chart& chart = inside.charts()[random() % inside.charts().size()];
    const Vec2 pixel(random() % chart.inside.width, random() % chart.inside.height);
    return Vec3(chart.plane.point(chart.plane.to_local(pixel)));
  };
  double jump = 0;
  for (int i = 0; i < 40; ++i) {
    const Vec3 from = end(), to = end();
    jump =
      std::max(jump, texture::largest_jump([&](const Vec3& p) { return inside.colour(p); }, is_inside, from, to, 100));
  }
  return jump;
}

TEST(InsideScenes, AreContinuous) {
  for (const char* scene : scenes) {
    const LookedInto looked = look_into(scene);
    const double across = jump_across_planes(looked.interior->inside);
    const double on_ways = jump_on_ways(looked.interior->inside, looked.mesh);
    std::printf("%s: largest jump across planes %.1e, on ways through the body %.1e\n", scene, across, on_ways);
    EXPECT_LT(across, 1e-3) << scene;
    EXPECT_LT(on_ways, 1e-3) << scene;
  }
}

TEST(InsideScenes, NoTriangleIsFlippedFromPictureToPicture) {
  for (const char* scene : scenes) {
    const LookedInto looked = look_into(scene);
    const texture::Interior& inside = looked.interior->inside;
    const auto folds = inside.folds();
    std::printf("%s: %zu triangles through %zu warps and fits, %zu flipped, least determinant %.1e\n", scene,
                folds.n_triangles, inside.n_pairs(), folds.n_flipped, inside.smallest_determinant());
    for (const texture::Chart& chart : inside.charts())
      EXPECT_LT(chart.fit_error.mean, 0.5) << scene; // pixels
    EXPECT_GT(folds.n_triangles, 1000u) << scene;
    EXPECT_EQ(folds.n_flipped, 0u) << scene;
  }
}

} // namespace
} // namespace kerf::scene::inside_scenes_test
