// Insides that cannot be, and pictures that can: what is said, at which place of the scene.

#include "base/error.h"
#include "image/file.h"
#include "scene/compose_interior.h"
#include "tests/geometry/meshes.h"
#include "tests/scene/worlds.h"
#include "texture/paint.h"

#include <gtest/gtest.h>
#include <png.h>

#include <cmath>
#include <fstream>

namespace kerf::scene::refused_inside_test {
namespace {

using Words = std::vector<std::string>;

class Inside : public testing::Test {
 protected:
  void SetUp() override {
    image::write_image(image::Colours(32, 32, image::Rgb(0.8f, 0.4f, 0.2f)), (folder / "good.png").string());
  }

  static std::string exemplar(const std::string& name, const std::string& picture, const std::string& origin,
                              const std::string& column = "0.0065, 0, 0", const std::string& row = "0, 0.0065, 0",
                              const std::string& more = "") {
    return "    subsection Exemplar " + name + "\n      set Image = " + picture + "\n      set Origin [m] = " + origin +
           "\n      set Column [m] = " + column + "\n      set Row [m] = " + row + "\n" + more + "    end\n";
  }

  static std::string scene(const std::string& inside) {
    std::string scene = cube_scene();
    const std::string end = "end\n";
    return scene.replace(scene.rfind(end), end.size(),
                         "  subsection Interior\n    set Resolution [m] = 0.01\n" + inside + "  end\n" + end);
  }

  LookedInto look(const std::string& text) const {
    return compose_inside(scan_scene_text(text, (folder / "scene.prm").string(), {}));
  }

  template <class Kind = ParameterError>
  void expect_refused(const std::string& text, const Words& parts) const {
    try {
      look(text);
      FAIL() << parts.back();
    } catch (const Kind& error) {
      const std::string said = error.what();
      EXPECT_NE(said.find("scene.prm:"), std::string::npos) << said;
      for (const std::string& part : parts)
        EXPECT_NE(said.find(part), std::string::npos) << "no '" << part << "' in: " << said;
    }
  }

  output::TemporaryFolder folder;
};

TEST_F(Inside, PinsThatDoNotFit) {
  const std::string two = exemplar("one", "good.png", "-0.1, -0.1, 0.01") +
                          exemplar("two", "good.png", "0.01, -0.1, -0.1", "0, 0.0065, 0", "0, 0, 0.0065");
  const auto pin = [](const std::string& to_exemplar, const std::string& from,
                      const std::string& to = "0.01, 0.02, 0.05") {
    return "    subsection Pin nose\n      set From exemplar = one\n      set To exemplar = " + to_exemplar +
           "\n      set From [m] = " + from + "\n      set To [m] = " + to + "\n    end\n";
  };
  expect_refused(scene(two + pin("two", "0.9, 0, 0.01")), {"Pin nose/From [m]", "0.9", "outside", "Move"});
  expect_refused(scene(two + pin("two", "0.05, 0, 0.01", "0.01, 0.9, 0.05")),
                 {"Pin nose/To [m]", "0.9", "outside", "Move"});
  expect_refused(scene(two + pin("two", "0.05, 0, 0.04")),
                 {"Pin nose/From [m]", "0.04", "0.03 m off the plane of exemplar one", "on the plane"});
  expect_refused(scene(two + pin("two", "0.05, 0, 0.01", "0.06, 0.02, 0.05")),
                 {"Pin nose/To [m]", "0.06", "0.05 m off the plane of exemplar two", "on the plane"});
  expect_refused(scene(two + pin("three", "0.05, 0, 0.01")), {"Pin nose/To exemplar", "names no exemplar"});
}

TEST_F(Inside, SaysHowMuchOfASectionAPictureShows) {
  const auto said = [&](const std::string& fit) {
    const LookedInto looked =
      look(scene(exemplar("one", "good.png", "-0.05, -0.1, 0.01", "0.0065, 0, 0", "0, 0.0065, 0", fit)));
    return looked.composition.back();
  };
  // 0.15 of the 0.2 m that the cube is wide, and half a pixel.
  EXPECT_EQ(said(""),
            "exemplar one: shows 77 % of the body's section; what lacks goes on from its border, as it is not "
            "fitted (key Fit)");
  EXPECT_NE(said("      set Fit = rigid\n").find("% of the body's section, drawn to it to 0"), std::string::npos);
}

TEST_F(Inside, TheBodyIsNamed) {
  const std::string text = scene(exemplar("one", "good.png", "-0.1, -0.1, 0.01"));
  const SceneText read = scan_scene_text(text, (folder / "scene.prm").string(), {});
  EXPECT_EQ(compose_inside(read, "cube").mesh.vertices.size(), compose_inside(read).mesh.vertices.size());
  EXPECT_THROW(compose_inside(read, "sphere"), ParameterError);
}

TEST_F(Inside, SweepsThatCannotTurn) {
  const auto swept = [](const std::string& sweep) {
    return scene(exemplar("one", "good.png", "-0.1, -0.1, 0.01", "0.0065, 0, 0", "0, 0.0065, 0", sweep));
  };
  expect_refused(swept("      set Sweep = axis\n      set Centre [m] = 0, 0, 0.01\n      set Axis [1] = 1, 0, 1\n"),
                 {"Exemplar one/Axis [1]", "1, 0, 1", "must lie in the plane", "right angle"});
  expect_refused(swept("      set Sweep = axis\n      set Centre [m] = 0, 0.03, 0.01\n      set Axis [1] = 1, 0, 0\n"),
                 {"Exemplar one/Axis [1]", "crosses a face", "Divide"});
  expect_refused(swept("      set Sweep = arc\n      set Centre [m] = 0.001, 0.001, 0.01\n"),
                 {"Exemplar one/Centre [m]", "0.001", "crosses a face", "Divide"});
}

TEST_F(Inside, SeveralComponents) {
  geometry::TriangleMesh arch = geometry::sphere_mesh(1, Vec3::Zero(), 3);
  for (Vec3& v : arch.vertices)
    v = Vec3(0.045 * v[0], 0.014 * v[1], 0.014 * v[2] - 22 * std::pow(0.045 * v[0], 2));
  image::write_image(image::Colours(128, 128, image::Rgb::Ones()), (folder / "fine.png").string());
  std::ofstream file(folder / "arch.off");
  file << "OFF\n" << arch.vertices.size() << " " << arch.triangles.size() << " 0\n";
  for (const Vec3& v : arch.vertices)
    file << v.transpose() << "\n";
  for (const Triangle& t : arch.triangles)
    file << "3 " << t[0] << " " << t[1] << " " << t[2] << "\n";
  file.close();
  std::string text = scene(exemplar("legs", "fine.png", "-0.048, -0.048, -0.02", "0.00075, 0, 0", "0, 0.00075, 0"));
  const std::string mesh = "set Mesh          = ";
  const std::size_t at = text.find(mesh) + mesh.size();
  text.replace(at, text.find('\n', at) - at, "arch.off");
  text.replace(text.find("Cube edge [m] = 0.05"), 20, "Cube edge [m] = 0.008");
  expect_refused(text, {"Interior/Components", "2 components", "exemplar legs", "one more exemplar"});
}

TEST_F(Inside, ResolutionsThatWouldTakeAllMemory) {
  const auto world = [&](const std::string& resolution, const std::string& edge, const std::string& more = "") {
    std::string text = scene(more + exemplar("one", "good.png", "-0.1, -0.1, 0.01"));
    text.replace(text.find("Resolution [m] = 0.01"), 21, "Resolution [m] = " + resolution);
    text.replace(text.find("Cube edge [m] = 0.05"), 20, "Cube edge [m] = " + edge);
    return compose(scan_scene_text(text, (folder / "scene.prm").string(), {}));
  };
  const auto expect = [&](const Words& parts, const auto&... arguments) {
    try {
      world(arguments...);
      FAIL() << parts.back();
    } catch (const ParameterError& error) {
      const std::string said = error.what();
      EXPECT_NE(said.find("scene.prm:"), std::string::npos) << said;
      EXPECT_NE(said.find("Interior/Resolution [m]"), std::string::npos) << said;
      for (const std::string& part : parts)
        EXPECT_NE(said.find(part), std::string::npos) << "no '" << part << "' in: " << said;
    }
  };
  // Two sides of 0.04 m^2, a sample a square of 1e-7 m, 3 bytes each; in triangles of half a cube some more.
  expect({"1e-7", "23000 GiB", "at least 0.00079"}, "1e-7", "0.05");
  expect({"0.0006", "at least 0.00079"}, "0.0006", "0.05");
  expect({"2.6 GiB", "at least 1.7e-5"}, "1e-5", "0.0005");
  expect({"9.3 GiB", "at least 3.5e-5"}, "1e-5", "0.0005", "    set Relief [m] = 0.001\n");
  expect({"11 GiB", "at least 3.7e-5"}, "1e-5", "0.0005", "    set Skin image = good.png\n");
  EXPECT_NE(world("0.0008", "0.05").bodies.front().interior, nullptr);
}

TEST_F(Inside, SkinPictures) {
  const std::string one = exemplar("one", "good.png", "-0.1, -0.1, 0.01");
  std::ofstream(folder / "text.png") << "no picture";
  expect_refused<DataError>(scene("    set Skin image = nothing.png\n" + one),
                            {"Interior/Skin image", "nothing.png", "there is no such file"});
  expect_refused<DataError>(scene("    set Skin image = text.png\n" + one),
                            {"Interior/Skin image", "neither a PNG nor a JPEG"});
  image::write_image(image::Image{image::Colours(32, 32, image::Rgb::Ones()), image::Grey(32, 32, 0)},
                     (folder / "empty.png").string());
  expect_refused(scene("    set Skin image = empty.png\n" + one), {"Interior/Skin image", "transparent all over"});
  std::filesystem::create_directory(folder / "pictures");
  expect_refused<DataError>(scene("    set Skin image = pictures\n" + one),
                            {"Interior/Skin image", "is a folder, not a picture"});
  expect_refused(scene("    set Skin image = good.png\n    set Skin axis [1] = 0, 0, 0\n" + one),
                 {"Interior/Skin axis [1]", "must have a length"});
}

/// Grey, and 16 bits a channel: as good as any.
TEST_F(Inside, GreyAndWidePictures) {
  const auto write_raw = [&](const char* name, const int format, const void* pixels) {
    png_image header = {};
    header.version = PNG_IMAGE_VERSION;
    header.width = header.height = 32;
    header.format = static_cast<png_uint_32>(format);
    ASSERT_TRUE(png_image_write_to_file(&header, (folder / name).c_str(), 0, pixels, 0, nullptr)) << header.message;
  };
  const std::vector<std::uint8_t> grey(32 * 32, 200);
  const std::vector<std::uint16_t> wide(32 * 32, 40000);
  write_raw("grey.png", PNG_FORMAT_GRAY, grey.data());
  write_raw("wide.png", PNG_FORMAT_LINEAR_Y, wide.data());
  for (const auto& [name, value] : {std::pair("grey.png", 200 / 255.0), std::pair("wide.png", 0.80)}) {
    const LookedInto looked = look(scene(exemplar("one", name, "-0.1, -0.1, 0.01")));
    const auto colour = looked.interior->inside.colour(Vec3(0.02, -0.03, 0.05));
    for (int channel = 0; channel < 3; ++channel)
      EXPECT_NEAR(colour[channel], value, 0.01) << name;
  }
}

} // namespace
} // namespace kerf::scene::refused_inside_test
