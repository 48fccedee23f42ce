// What is inside of a body, in a scene: built only where the scene asks for it, coloured as cuts reveal it, written
// out.

#include "base/error.h"
#include "output/h5_array.h"
#include "tests/scene/striped_cube.h"

#include <hdf5.h>

#include <fstream>
#include <map>

namespace kerf::scene::interior_test {
namespace {

class InteriorScene : public StripedCube {};

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
  World world = composed(at_resolution(scene(), "0.002"));
  run_silently(world, folder / "out");
  const texture::Atlas& atlas = world.bodies.front().interior->atlas;
  const auto n = static_cast<double>(atlas.colours().size());
  double n_now = 0;
  for (const int parts : atlas.parts())
    n_now += parts > 0 ? static_cast<double>(texture::n_samples(parts)) : 0;
  const double expected = texture::n_samples_of(2 * 0.2 * 0.2, 0.002, 0.05);
  std::printf("room for %.0f samples on both sides of a cut, %.0f of it in use, %.0f expected\n", n, n_now, expected);
  EXPECT_GT(n_now, expected);
  EXPECT_LT(n, 1.5 * expected); // triangles at the rim are smaller
}

/// Of each triangle that has samples, its rows in the run's file, where a row has n numbers.
template <class Number>
std::vector<std::vector<Number>> rows_of_triangles(const std::filesystem::path& run, const std::string& set,
                                                   const texture::Atlas& atlas, const std::size_t n) {
  const auto file = output::h5::open_read_only(run);
  const auto surface = "/bodies/cube/surface/" + output::h5::children(file, "/bodies/cube/surface").back();
  const auto first = output::h5::read_vector<std::uint32_t>(file, surface + "/first_sample");
  const auto all = output::h5::read_vector<Number>(file, "/bodies/cube/" + set);
  EXPECT_EQ(first.size(), atlas.first().size());
  std::vector<std::vector<Number>> rows;
  for (std::size_t t = 0; t < first.size(); ++t)
    if (atlas.parts()[t] > 0) {
      const std::size_t begin = n * first[t], end = begin + n * texture::n_samples(atlas.parts()[t]);
      rows.emplace_back();
      for (std::size_t i = begin; i < end; ++i)
        rows.back().push_back(all.at(i));
    }
  return rows;
}

/// The same of what the atlas has.
template <class Number, std::size_t n>
std::vector<std::vector<Number>> samples_of_triangles(const texture::Atlas& atlas,
                                                      const std::vector<std::array<Number, n>>& samples) {
  std::vector<std::vector<Number>> rows;
  for (std::size_t t = 0; t < atlas.first().size(); ++t)
    if (atlas.parts()[t] > 0) {
      rows.emplace_back();
      for (std::size_t i = 0; i < texture::n_samples(atlas.parts()[t]); ++i)
        rows.back().insert(rows.back().end(), samples[atlas.first()[t] + i].begin(),
                           samples[atlas.first()[t] + i].end());
    }
  return rows;
}

TEST_F(InteriorScene, IsInTheRunFile) {
  World world = this->world();
  run_silently(world, folder / "out");
  const texture::Atlas& atlas = world.bodies.front().interior->atlas;
  const auto wanted = samples_of_triangles(atlas, atlas.colours());
  EXPECT_GT(wanted.size(), 20u);
  EXPECT_EQ(rows_of_triangles<std::uint8_t>(folder / "out" / "run.h5", "colours", atlas, 3), wanted);
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

TEST_F(InteriorScene, AReliefIsInTheRunFileAndChangesNoColour) {
  const auto samples = [&](const std::string& more) {
    World world = composed(striped_across(scene(more)));
    run_silently(world, folder / "out");
    return world.bodies.front().interior->atlas;
  };
  const texture::Atlas smooth = samples(""), rough = samples("    set Relief [m] = 0.001\n");
  EXPECT_TRUE(smooth.slopes().empty());
  EXPECT_EQ(smooth.colours(), rough.colours());
  ASSERT_EQ(rough.slopes().size(), rough.colours().size());
  const auto written = rows_of_triangles<float>(folder / "out" / "run.h5", "slopes", rough, 2);
  EXPECT_EQ(written, samples_of_triangles(rough, rough.slopes()));
  float steepest = 0;
  for (const auto& rows : written)
    for (const float slope : rows)
      steepest = std::max(steepest, std::abs(slope));
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
