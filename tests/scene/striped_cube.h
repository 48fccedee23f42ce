#pragma once

/// A cube that is striped inside, and a blade that falls through it.

#include "image/file.h"
#include "scene/compose_interior.h"
#include "tests/scene/worlds.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

namespace kerf::scene {

/// A picture of stripes, 64 x 64.
inline void write_stripes(const std::filesystem::path& path) {
  image::Image picture{image::Colours(64, 64, image::Rgb::Zero()), {}};
  for (int r = 0; r < 64; ++r)
    for (int c = 0; c < 64; ++c)
      picture.colours(c, r) = (c / 8) % 2 == 0 ? image::Rgb(1, 0, 0) : image::Rgb(0, 0, 1);
  image::write_image(picture, path.string());
}

/// The cube's inside: stripes in the plane z = 0.01.
inline std::string interior(const std::filesystem::path& picture, const std::string& more = "") {
  return "  subsection Interior\n    set Resolution [m] = 0.01\n" + more +
         "    subsection Exemplar middle\n      set Image = " + picture.string() +
         "\n      set Origin [m] = -0.1, -0.1, 0.01\n      set Column [m] = 0.0032, 0, 0\n"
         "      set Row [m] = 0, 0.0032, 0\n    end\n  end\n";
}

inline std::string scene_with(const std::string& inside) {
  std::string scene = cube_scene();
  const std::string end = "end\n";
  scene.replace(scene.rfind(end), end.size(), inside + end);
  return scene + falling_blade();
}

inline std::string with(std::string text, const std::string& given, const std::string& wanted) {
  return text.replace(text.find(given), given.size(), wanted);
}

/// The blade at x = 0.003 m runs along a stripe: here stripes run across it.
inline std::string striped_across(const std::string& scene) {
  return with(with(scene, "Column [m] = 0.0032, 0, 0", "Column [m] = 0, 0.0032, 0"), "Row [m] = 0, 0.0032, 0",
              "Row [m] = 0.0032, 0, 0");
}

/// With samples so fine [m].
inline std::string at_resolution(const std::string& scene, const std::string& resolution) {
  return with(scene, "Resolution [m] = 0.01", "Resolution [m] = " + resolution);
}

class StripedCube : public testing::Test {
 protected:
  void SetUp() override { write_stripes(folder / "stripes.png"); }
  World composed(const std::string& scene) const {
    return compose(scan_scene_text(scene, (folder / "scene.prm").string(), {}));
  }
  std::string scene(const std::string& more = "") const { return scene_with(interior(folder / "stripes.png", more)); }
  World world(const std::string& more = "") const { return composed(scene(more)); }
  output::TemporaryFolder folder;
};

/// What a body's interior shows on a surface, painted at once.
inline texture::Atlas painted_anew(const BodyInterior& interior, const texture::SurfaceView& surface,
                                   const double resolution) {
  texture::Atlas atlas(resolution);
  atlas.fill(surface,
             {&interior.inside, interior.detail.get(), interior.skin ? &*interior.skin : nullptr, interior.relief});
  return atlas;
}

} // namespace kerf::scene
