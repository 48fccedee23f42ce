// Cut surfaces as a scene writes them: when they cut, what they leave, and what is refused.

#include "base/error.h"
#include "tests/geometry/meshes.h"
#include "tests/scene/worlds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <sstream>

namespace kerf::scene::cut_surface_test {
namespace {

std::string surface_text(const std::string& name, const std::string& keys) {
  std::string text = "subsection Cut surface " + name + "\n";
  std::string line;
  for (const char c : keys + ";")
    if (c == ';') {
      text += "  set " + line + "\n";
      line.clear();
    } else {
      line += c;
    }
  return text + "end\n";
}

/// Along z, a little beside the middle of the cube; edges are 0.05 m.
std::string plane(const std::string& more = "") {
  return surface_text("slice", "Shape = plane;Point [m] = 0, 0, 0.003;Normal [1] = 0, 0, 5" + more);
}

TEST(CutSurfaceScene, CutsBeforeTheStepThatBeginsAtItsTime) {
  const auto is_step = [](const std::string& time, const int step) {
    EXPECT_EQ(world_of(cube_scene() + plane(";Time [s] = " + time)).cut_surfaces.at(0).step, step) << time;
  };
  is_step("0", 1);
  is_step("0.02", 3); // 0.02 / 0.01 is not 2 in every rounding
  is_step("0.03", 4);
  is_step("0.031", 5);
  EXPECT_EQ(world_of(cube_scene() + plane()).cut_surfaces.at(0).step, 1);
}

TEST(CutSurfaceScene, CarriesStateAndCountsItsEdges) {
  World world = world_of(cube_scene() + falling_blade() + plane());
  ASSERT_EQ(world.cut_surfaces.size(), 1u);
  EXPECT_EQ(world.cut_surfaces[0].surface.label, 2) << "after the blade";
  Body& body = world.bodies[0];
  body.state.v.assign(body.solid.complex.n_corners(), Vec3(3, 1, -2));
  const double mass = value(body, "mass"), energy = value(body, "kinetic energy");
  Timings timings;
  cut_at_once(body, world.cut_surfaces[0].surface, timings);
  EXPECT_EQ(value(body, "pieces"), 2);
  EXPECT_EQ(value(body, "cut edges"), 16);
  EXPECT_EQ(body.cutter->counts().n_cut_edges, (std::vector<std::size_t>{0, 16}));
  EXPECT_NEAR(value(body, "mass"), mass, 1e-12 * mass);
  EXPECT_NEAR(value(body, "momentum x"), 3 * mass, 1e-12 * mass);
  EXPECT_NEAR(value(body, "kinetic energy"), energy, 1e-12 * energy);
  EXPECT_EQ(body.cutter->stands_at().size(), body.solid.complex.n_corners()) << "the blade goes on from there";
  recut(body, world.blades, 0, 0.05, timings);
  EXPECT_GT(body.cutter->counts().n_cut_edges[0], 0u);
  EXPECT_EQ(body.cutter->counts().n_cut_edges[1], 16u);
}

TEST(CutSurfaceScene, RunsBesideABladeAndSaysSo) {
  const output::TemporaryFolder folder;
  World world = world_of(cube_scene() + falling_blade() + plane(";Time [s] = 0.02"));
  EXPECT_NE(std::find(world.composition.begin(), world.composition.end(), "cut surface slice: cuts at 0.02 s"),
            world.composition.end());
  run_silently(world, folder / "run");
  EXPECT_EQ(value(world.bodies[0], "pieces"), 4);
}

/// What the disc of a later time meets is where the body is then: here, far from where it was at rest.
TEST(CutSurfaceScene, CutsTheBodyWhereItStands) {
  const auto scene = [](const double x) {
    std::string text = cube_scene();
    text.insert(text.rfind("end\n"),
                "  subsection Support all\n"
                "    set Lower [m]        = -1, -1, -1\n"
                "    set Upper [m]        = 1, 1, 1\n"
                "    set Displacement [m] = 10*t; 0; 0\n"
                "  end\n");
    return text +
           surface_text("slice", "Time [s] = 0.04;Shape = disc;Normal [1] = 1, 0, 0;Radius [m] = 1;Point [m] = " +
                                   std::to_string(x) + ", 0, 0");
  };
  const output::TemporaryFolder folder;
  World there = world_of(scene(0.403)), at_rest = world_of(scene(0.003));
  run_silently(there, folder / "there");
  run_silently(at_rest, folder / "rest");
  EXPECT_EQ(value(there.bodies[0], "pieces"), 2);
  EXPECT_EQ(value(at_rest.bodies[0], "pieces"), 1);
}

TEST(CutSurfaceScene, EveryShapeComposes) {
  for (const std::string keys :
       {"Shape = sphere;Point [m] = 0, 0, 0;Radius [m] = 0.06",
        "Shape = cylinder;Point [m] = 0, 0, 0;Axis [1] = 0, 1, 0;Radius [m] = 0.06;Height [m] = 0.1"}) {
    World world = world_of(cube_scene() + surface_text("core", keys));
    Timings timings;
    cut_at_once(world.bodies[0], world.cut_surfaces[0].surface, timings);
    EXPECT_EQ(value(world.bodies[0], "pieces"), 2) << keys;
  }
  World world =
    world_of(cube_scene() + surface_text("box", "Shape = mesh;Mesh unit [m] = 0.5;Mesh = " + mesh_path("cube.off")));
  Timings timings;
  cut_at_once(world.bodies[0], world.cut_surfaces[0].surface, timings);
  EXPECT_EQ(value(world.bodies[0], "pieces"), 2);
}

std::string off_text(const geometry::TriangleMesh& mesh) {
  std::ostringstream text;
  text.precision(17);
  text << "OFF\n" << mesh.vertices.size() << ' ' << mesh.triangles.size() << " 0\n";
  for (const Vec3& v : mesh.vertices)
    text << v[0] << ' ' << v[1] << ' ' << v[2] << '\n';
  for (const auto& [a, b, c] : mesh.triangles)
    text << "3 " << a << ' ' << b << ' ' << c << '\n';
  return text.str();
}

/// The cube, cut at once by a mesh.
World cut_by(const geometry::TriangleMesh& mesh) {
  const output::TemporaryFolder folder;
  std::ofstream(folder / "mesh.off") << off_text(mesh);
  World world = world_of(cube_scene() + surface_text("box", "Shape = mesh;Mesh = " + (folder / "mesh.off").string()),
                         {"Body cube/Cube edge [m]=0.02"});
  Timings timings;
  cut_at_once(world.bodies[0], world.cut_surfaces[0].surface, timings);
  return world;
}

/// Two boxes through each other are the border of what lies in one of them alone: where both are, it crosses evenly.
TEST(CutSurfaceScene, AMeshThroughItselfCutsWhereItCrossesOddly) {
  const Box one{Vec3::Constant(-0.065), Vec3::Constant(0.026)}, other{Vec3::Constant(-0.034), Vec3::Constant(0.063)};
  const World world =
    cut_by(geometry::together(geometry::box_mesh(one.lower, one.upper), geometry::box_mesh(other.lower, other.upper)));
  const Body& body = world.bodies[0];
  const auto is_in_one = [&](const grid::NodeId n) {
    const Vec3 X = body.solid.grid.position(n);
    return one.contains(X) != other.contains(X);
  };
  std::size_t n_wrong = 0, n_cut = 0;
  for (const auto e : ids<grid::EdgeId>(body.solid.grid.n_edges())) {
    const auto& [a, b] = body.solid.grid.ends(e);
    if (body.solid.grid.is_material(a) && body.solid.grid.is_material(b)) {
      n_wrong += body.solid.cuts.is_cut(e) != (is_in_one(a) != is_in_one(b)) ? 1 : 0;
      n_cut += body.solid.cuts.is_cut(e) ? 1 : 0;
    }
  }
  EXPECT_EQ(n_wrong, 0u);
  EXPECT_EQ(value(body, "cut edges"), n_cut);
  EXPECT_EQ(value(body, "pieces"), 4) << "outside, in both, and in either alone";
  EXPECT_NEAR(value(body, "mass"), 8, 1e-11);
}

/// Open sheets that reach beyond the cube on all sides, waved and tilted so that they pass the skin between its edges:
/// no bridge is left. A sheet that ends inside parts nothing.
TEST(CutSurfaceScene, AnOpenMeshThroughTheBodyPartsIt) {
  const auto sheet = [](const double reach, const double amplitude, const double tilt, const double height) {
    constexpr int n = 24;
    geometry::TriangleMesh mesh;
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) {
        const double x = -0.3 + (0.3 + reach) * i / n, y = -0.3 + 0.6 * j / n;
        mesh.vertices.emplace_back(x, y, height + tilt * x + amplitude * std::sin(40 * x) * std::cos(30 * y));
      }
    for (std::uint32_t j = 0; j < n; ++j)
      for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t a = i + (n + 1) * j, b = a + n + 1;
        mesh.triangles.push_back({a, a + 1, b});
        mesh.triangles.push_back({a + 1, b + 1, b});
      }
    return mesh;
  };
  for (int i = 0; i < 12; ++i) {
    const double amplitude = 0.004 * i, tilt = 0.05 * (i % 5), height = 0.013 * (i - 6);
    EXPECT_EQ(value(cut_by(sheet(0.3, amplitude, tilt, height)).bodies[0], "pieces"), 2) << i;
    EXPECT_EQ(value(cut_by(sheet(0.02, amplitude, tilt, height)).bodies[0], "pieces"), 1) << i;
  }
}

TEST(CutSurfaceScene, AMeshThatLiesOnItselfTwiceCutsNothing) {
  const auto box = geometry::box_mesh(Vec3::Constant(-0.065), Vec3::Constant(0.026));
  const World world = cut_by(geometry::together(box, box));
  EXPECT_EQ(value(world.bodies[0], "cut edges"), 0);
  EXPECT_GT(value(world.bodies[0], "double crossings"), 0) << "and says what it left whole";
}

void expect_refused(const std::string& section, const std::vector<std::string>& words) {
  const std::string text = cube_scene() + section;
  try {
    world_of(text);
    ADD_FAILURE() << "accepted:\n" << section;
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_EQ(message.find("scene.prm:"), 0u) << message;
    EXPECT_NE(message.find("Cut surface slice"), std::string::npos) << message;
    for (const std::string& word : words)
      EXPECT_NE(message.find(word), std::string::npos) << "'" << word << "' is not in: " << message;
  }
}

TEST(CutSurfaceScene, RefusesWhatIsNoCut) {
  const auto refuse = [](const std::string& keys, const std::vector<std::string>& words) {
    expect_refused(surface_text("slice", keys), words);
  };
  refuse("Point [m] = 0, 0, 0", {"Shape", "must be one of plane"});
  refuse("Shape = cone", {"'cone'", "must be one of plane, sphere, cylinder, disc, rectangle, mesh"});
  refuse("Shape = sphere;Point [m] = 0, 0, 0;Radius [m] = 0", {"Radius [m]", "'0'", "must be > 0"});
  refuse("Shape = sphere;Point [m] = 0, 0, 0;Radius [m] = -1", {"Radius [m]", "must be > 0"});
  refuse("Shape = sphere;Radius [m] = 1", {"'sphere' must have the key 'Point [m]'"});
  refuse("Shape = sphere;Point [m] = 0, 0, 0;Radius [m] = 1;Normal [1] = 0, 0, 1",
         {"Normal [1]", "'sphere' does not read this key", "Point [m], Radius [m]"});
  refuse("Shape = plane;Point [m] = 0, 0, 0;Normal [1] = 0, 0, 0", {"Normal [1] = '0, 0, 0'", "not zero"});
  refuse("Shape = cylinder;Point [m] = 0, 0, 0;Axis [1] = 0, 0, 0;Radius [m] = 1;Height [m] = 1",
         {"Axis [1]", "not zero"});
  refuse("Shape = mesh", {"'mesh' must have the key 'Mesh'"});
  refuse("Shape = mesh;Mesh = nowhere.off", {"Mesh", "nowhere.off"});
  expect_refused(plane(";Time [s] = -1"), {"Time [s]", "must be >= 0"});
  expect_refused(plane(";Time [s] = 0.05"), {"Time [s] = '0.05'", "before the last step", "0.04 s"});
}

} // namespace
} // namespace kerf::scene::cut_surface_test
