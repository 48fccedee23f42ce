// What is inside of a body, in a scene: built only where the scene asks for it, coloured as cuts reveal it, written
// out.

#include "base/error.h"
#include "image/file.h"
#include "scene/compose_interior.h"
#include "tests/scene/worlds.h"

#include <gtest/gtest.h>
#include <hdf5.h>

#include <fstream>
#include <map>

namespace kerf::scene::interior_test {
namespace {

/// A picture of stripes, 64 x 64.
void write_stripes(const std::filesystem::path& path) {
  image::Image picture{image::Colours(64, 64, image::Rgb::Zero()), {}};
  for (int r = 0; r < 64; ++r)
    for (int c = 0; c < 64; ++c)
      picture.colours(c, r) = (c / 8) % 2 == 0 ? image::Rgb(1, 0, 0) : image::Rgb(0, 0, 1);
  image::write_image(picture, path.string());
}

/// The cube's inside: stripes in the plane z = 0.01.
std::string interior(const std::filesystem::path& picture, const std::string& more = "") {
  return "  subsection Interior\n    set Resolution [m] = 0.01\n" + more +
         "    subsection Exemplar middle\n      set Image = " + picture.string() +
         "\n      set Origin [m] = -0.1, -0.1, 0.01\n      set Column [m] = 0.0032, 0, 0\n"
         "      set Row [m] = 0, 0.0032, 0\n    end\n  end\n";
}

std::string scene_with(const std::string& inside) {
  std::string scene = cube_scene();
  const std::string end = "end\n";
  scene.replace(scene.rfind(end), end.size(), inside + end);
  return scene + falling_blade();
}

class InteriorScene : public testing::Test {
 protected:
  void SetUp() override { write_stripes(folder / "stripes.png"); }
  World world(const std::string& more = "") const {
    return compose(
      scan_scene_text(scene_with(interior(folder / "stripes.png", more)), (folder / "scene.prm").string(), {}));
  }
  output::TemporaryFolder folder;
};

TEST(NoInterior, BuildsNone) {
  const World world = world_of(cube_scene());
  EXPECT_EQ(world.bodies.front().interior, nullptr);
  EXPECT_NE(std::find(world.composition.begin(), world.composition.end(),
                      "left out: Interior (revealed faces have one colour)"),
            world.composition.end());
}

TEST_F(InteriorScene, RevealedFacesAreColouredAsTheyAppear) {
  World world = this->world();
  Body& body = world.bodies.front();
  ASSERT_NE(body.interior, nullptr);
  EXPECT_TRUE(body.interior->atlas.colours().empty());
  const Timings seconds = run_silently(world, folder / "out");
  EXPECT_GT(seconds.at("colour"), 0);
  const texture::Atlas& atlas = body.interior->atlas;
  std::size_t n_revealed = 0;
  for (std::size_t t = 0; t < body.surface.triangles.size(); ++t) {
    EXPECT_EQ(atlas.first()[t] != texture::Atlas::none, body.surface.labels[t] > 0);
    n_revealed += body.surface.labels[t] > 0 ? 1 : 0;
  }
  EXPECT_GT(n_revealed, 20u);
  // One exemplar swept along its normal: the stripe at x of the cut, 0.003 to 0.006 m, is the one of columns 32 to 39.
  for (const auto& [red, green, blue] : atlas.colours()) {
    EXPECT_EQ(green, 0);
    EXPECT_EQ(red + blue, 255);
  }
  const auto colours = vertex_colours(atlas, body.surface, Vec3(0.1, 0.2, 0.3));
  ASSERT_EQ(colours.size(), 3 * body.surface.rest.size());
}

TEST_F(InteriorScene, SamplesAreAboutAsManyAsExpected) {
  std::string text = scene_with(interior(folder / "stripes.png"));
  text.replace(text.find("Resolution [m] = 0.01"), 21, "Resolution [m] = 0.002");
  World world = compose(scan_scene_text(text, (folder / "scene.prm").string(), {}));
  run_silently(world, folder / "out");
  const texture::Atlas& atlas = world.bodies.front().interior->atlas;
  const auto n = static_cast<double>(atlas.colours().size());
  double n_now = 0; // those of triangles that the blade has moved on are left behind
  for (const int parts : atlas.parts())
    n_now += parts > 0 ? static_cast<double>(texture::n_samples(parts)) : 0;
  const double expected = texture::n_samples_of(2 * 0.2 * 0.2, 0.002, 0.05);
  std::printf("%.0f samples on both sides of a cut, %.0f of them still in use, %.0f expected\n", n, n_now, expected);
  EXPECT_GT(n_now, expected);
  EXPECT_LT(n_now, 1.5 * expected); // triangles at the rim are smaller
  EXPECT_LT(n, 2.5 * expected); // and each time that its front moves on within a cell
}

TEST_F(InteriorScene, IsInTheRunFile) {
  World world = this->world();
  run_silently(world, folder / "out");
  const texture::Atlas& atlas = world.bodies.front().interior->atlas;
  const hid_t file = H5Fopen((folder / "out" / "run.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  ASSERT_GE(file, 0);
  const hid_t set = H5Dopen2(file, "/bodies/cube/colours", H5P_DEFAULT);
  ASSERT_GE(set, 0);
  std::vector<std::array<std::uint8_t, 3>> samples(atlas.colours().size());
  const hid_t space = H5Dget_space(set);
  ASSERT_EQ(H5Sget_simple_extent_npoints(space), static_cast<hssize_t>(3 * samples.size()));
  H5Dread(set, H5T_NATIVE_UINT8, H5S_ALL, H5S_ALL, H5P_DEFAULT, samples.data());
  EXPECT_EQ(samples, atlas.colours());
  H5Sclose(space);
  H5Dclose(set);
  H5Fclose(file);
}

TEST_F(InteriorScene, IsInTheSurfaceFile) {
  const std::string text = scene_with(interior(folder / "stripes.png")) + "subsection Surface file\nend\n";
  World world = compose(scan_scene_text(text, (folder / "scene.prm").string(), {}));
  run_silently(world, folder / "out");
  const hid_t file = H5Fopen((folder / "out" / "surface_cube.vtkhdf").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  ASSERT_GE(file, 0);
  const hid_t set = H5Dopen2(file, "/VTKHDF/PointData/colour", H5P_DEFAULT);
  ASSERT_GE(set, 0);
  const hid_t space = H5Dget_space(set);
  const Body& body = world.bodies.front();
  std::vector<float> rows(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
  ASSERT_GE(rows.size(), 3 * body.surface.rest.size());
  H5Dread(set, H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, rows.data());
  const auto last = vertex_colours(body.interior->atlas, body.surface, render::Look().skin);
  for (std::size_t i = 0; i < last.size(); ++i)
    ASSERT_EQ(rows[rows.size() - last.size() + i], static_cast<float>(last[i])) << i;
  H5Sclose(space);
  H5Dclose(set);
  H5Fclose(file);
}

TEST_F(InteriorScene, WarpsAreKeptBesideTheSceneAndReadAgain) {
  const auto said = [](const World& world, const std::string& words) {
    return std::any_of(world.composition.begin(), world.composition.end(),
                       [&](const std::string& line) { return line.find(words) != std::string::npos; });
  };
  EXPECT_TRUE(said(world(), "found, and kept in"));
  EXPECT_TRUE(said(world(), "read from"));
  std::filesystem::remove_all(folder / "cache");
  std::ofstream(folder / "cache") << "a file where the folder would be";
  EXPECT_TRUE(said(world(), "cannot be kept"));
}

std::vector<float> read_floats(const std::filesystem::path& path, const char* name) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const hid_t set = H5Dopen2(file, name, H5P_DEFAULT), space = H5Dget_space(set);
  std::vector<float> values(static_cast<std::size_t>(std::max<hssize_t>(H5Sget_simple_extent_npoints(space), 0)));
  H5Dread(set, H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  H5Sclose(space);
  H5Dclose(set);
  H5Fclose(file);
  return values;
}

TEST_F(InteriorScene, AReliefIsInTheRunFileAndChangesNoColour) {
  const auto samples = [&](const std::string& more) {
    // The blade at x = 0.003 m would run along a stripe: here stripes run across it.
    std::string text = scene_with(interior(folder / "stripes.png", more));
    for (const auto& [from, to] : {std::pair("Column [m] = 0.0032, 0, 0", "Column [m] = 0, 0.0032, 0"),
                                   std::pair("Row [m] = 0, 0.0032, 0", "Row [m] = 0.0032, 0, 0")})
      text.replace(text.find(from), std::string(from).size(), to);
    World world = compose(scan_scene_text(text, (folder / "scene.prm").string(), {}));
    run_silently(world, folder / "out");
    return world.bodies.front().interior->atlas;
  };
  const texture::Atlas smooth = samples(""), rough = samples("    set Relief [m] = 0.001\n");
  EXPECT_TRUE(smooth.slopes().empty());
  EXPECT_EQ(smooth.colours(), rough.colours());
  ASSERT_EQ(rough.slopes().size(), rough.colours().size());
  float steepest = 0;
  const auto written = read_floats(folder / "out" / "run.h5", "/bodies/cube/slopes");
  ASSERT_EQ(written.size(), 2 * rough.slopes().size());
  for (std::size_t i = 0; i < rough.slopes().size(); ++i)
    for (const int k : {0, 1}) {
      EXPECT_EQ(written[2 * i + k], rough.slopes()[i][k]);
      steepest = std::max(steepest, std::abs(written[2 * i + k]));
    }
  EXPECT_GT(steepest, 1e-4f); // a stripe's edge: 0.14 mm of luminance over some millimetres
}

TEST_F(InteriorScene, SmallFeaturesAreBuiltWhereAskedFor) {
  World plain = this->world(), detailed = this->world("    set Small features = yes\n");
  EXPECT_EQ(plain.bodies.front().interior->detail, nullptr);
  EXPECT_NE(detailed.bodies.front().interior->detail, nullptr);
}

/// The colours at the corners and along the sides of a revealed triangle, by where it lies.
using Samples = std::map<std::array<double, 9>, std::vector<std::array<std::uint8_t, 3>>>;
Samples samples_of(const Body& body) {
  Samples samples;
  const texture::Atlas& atlas = body.interior->atlas;
  for (std::size_t t = 0; t < body.surface.triangles.size(); ++t) {
    if (atlas.first()[t] == texture::Atlas::none)
      continue;
    std::array<double, 9> place;
    for (int i = 0; i < 9; ++i)
      place[i] = body.surface.rest[body.surface.triangles[t][i / 3]][i % 3];
    const auto first = atlas.colours().begin() + atlas.first()[t];
    samples[place] = {first, first + static_cast<std::ptrdiff_t>(texture::n_samples(atlas.parts()[t]))};
  }
  return samples;
}

TEST_F(InteriorScene, ALaterCutChangesNothingThatStays) {
  const auto cut = [](const std::string& name, const std::string& time, const std::string& normal) {
    return "subsection Cut surface " + name + "\n  set Time [s] = " + time +
           "\n  set Shape = plane\n  set Point [m] = 0.004, 0.007, 0.003\n  set Normal [1] = " + normal + "\nend\n";
  };
  const auto run_with = [&](const std::string& cuts) {
    std::string text = cube_scene();
    text.replace(text.rfind("end\n"), 4, interior(folder / "stripes.png", "    set Small features = yes\n") + "end\n");
    World world = compose(scan_scene_text(text + cuts, (folder / "scene.prm").string(), {}));
    run_silently(world, folder / "out");
    return world;
  };
  const std::string first = cut("first", "0.01", "0.2, 1, 0.1"), second = cut("second", "0.03", "1, 0.1, 0.3");
  const World once = run_with(first), twice = run_with(first + second);
  const auto& before = once.bodies.front().interior->atlas.colours();
  const auto& after = twice.bodies.front().interior->atlas.colours();
  ASSERT_GT(after.size(), before.size());
  EXPECT_TRUE(std::equal(before.begin(), before.end(), after.begin()));
  const Samples old = samples_of(once.bodies.front()), all = samples_of(twice.bodies.front());
  std::size_t n_same = 0;
  for (const auto& [place, colours] : old)
    if (const auto found = all.find(place); found != all.end()) {
      EXPECT_EQ(found->second, colours);
      ++n_same;
    }
  EXPECT_GT(n_same, old.size() / 3);
  EXPECT_LT(n_same, old.size()); // the second cut parts some of the first one's faces
}

TEST_F(InteriorScene, ASkinImageColoursTheSkin) {
  World world = this->world("    set Skin image = stripes.png\n");
  const texture::Atlas& atlas = world.bodies.front().interior->atlas;
  EXPECT_EQ(std::count(atlas.first().begin(), atlas.first().end(), texture::Atlas::none), 0);
}

} // namespace
} // namespace kerf::scene::interior_test
