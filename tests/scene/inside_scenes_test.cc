// The scenes that say what is inside, with their photographs.

#include "scene/compose_interior.h"

#include <gtest/gtest.h>

namespace kerf::scene {
namespace {

LookedInto look_into(const std::string& scene) {
  return compose_inside(read_scene_text(std::string(KERF_SOURCE_DIR) + "/params/" + scene, {}));
}

TEST(InsideScenes, NoTriangleIsFlippedFromPictureToPicture) {
  for (const char* scene :
       {"brain.prm", "thesis/fig_3_28.prm", "thesis/fig_3_29.prm", "thesis/fig_3_30.prm", "thesis/fig_3_32.prm"}) {
    const LookedInto looked = look_into(scene);
    const texture::Interior& inside = looked.interior->inside;
    const auto folds = inside.folds();
    std::printf("%s: %zu triangles through %zu warps and fits, %zu flipped, least determinant %.1e\n", scene,
                folds.n_triangles, inside.n_pairs(), folds.n_flipped, inside.smallest_determinant());
    for (const texture::Chart& chart : inside.charts())
      EXPECT_LT(chart.fit_error, 0.5) << scene; // pixels
    EXPECT_GT(folds.n_triangles, 1000u) << scene;
    EXPECT_EQ(folds.n_flipped, 0u) << scene;
  }
}

} // namespace
} // namespace kerf::scene
