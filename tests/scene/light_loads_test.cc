// Loads on the surface of what hardly any material holds.

#include "dynamics/quantities.h"
#include "tests/scene/trials.h"

#include <fstream>

namespace kerf::scene::light_loads_test {
namespace {

/// A cube of .05 m with a pyramid of .075 m on each side.
std::string star() {
  std::ostringstream text;
  text << "OFF\n14 24 0\n";
  for (int v = 0; v < 8; ++v)
    text << (v & 1 ? 0.025 : -0.025) << ' ' << (v & 2 ? 0.025 : -0.025) << ' ' << (v & 4 ? 0.025 : -0.025) << '\n';
  for (int axis = 0; axis < 3; ++axis)
    for (const double tip : {-0.1, 0.1}) {
      Vec3 p = Vec3::Zero();
      p[axis] = tip;
      text << p[0] << ' ' << p[1] << ' ' << p[2] << '\n';
    }
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      const int u = 1 << (axis + 1) % 3, w = 1 << (axis + 2) % 3, first = side << axis;
      const std::array<int, 4> around = {first, first | u, first | u | w, first | w};
      for (int k = 0; k < 4; ++k) {
        const int a = around[k], b = around[(k + 1) % 4];
        text << "3 " << (side ? a : b) << ' ' << (side ? b : a) << ' ' << 8 + 2 * axis + side << '\n';
      }
    }
  return text.str();
}

/// The tips have copies of a millionth of a cube, with a surface that a traction acts on.
TEST(LightLoads, TipsOfSpringsAndLatticesBearTractions) {
  const output::TemporaryFolder folder;
  std::ofstream(folder / "star.off") << star();
  for (const std::string backend : {"mass-spring", "lattice"}) {
    SCOPED_TRACE(backend);
    const std::string inside =
      material(1e5, 0.25) + section("Support foot", box("-1, -1, -1", "1, -0.06, 1")) +
      section("Traction pull", {"Traction [N/m^2] = 2; -5.9; 5.3"}) +
      (backend == "lattice" ? section("Lattice", {"Alpha [1] = 0.9"}) : ""); // of some kPa
    const Trial pulled(steps(1.0 / 120, 24) +
                       section("Body b", Keys{"Mesh = " + (folder / "star.off").string(),
                                              key("Cube edge [m]", 0.2 / 14), "Backend = " + backend},
                               inside) +
                       observe("largest stretch, largest displacement, load forces"));
    EXPECT_LT(pulled.last("largest stretch"), 1.5);
    EXPECT_LT(pulled.last("largest displacement"), 0.05);
    const double area = 24 * 0.5 * 0.05 * std::hypot(0.075, 0.025);
    EXPECT_NEAR(pulled.last("force of pull z"), 5.3 * area, 0.05 * 5.3 * area);
  }
}

/// A plane cuts a corner with legs of `s` off a cube. Returns the world after some steps.
World without_corner(const double s, const std::string& offset, const std::string& load) {
  const std::string middle = to_text(-0.1 + s / 3);
  World world = world_of(
    steps(0.01, 5) +
    section("Body b",
            Keys{"Mesh = " + mesh_path("cube.off"), "Cube edge [m] = 0.04", "Lattice offset [1] = " + offset},
            material(2e4, 0.3) + section("Support roof", box("-1, -1, 0.05", "1, 1, 1")) + load) +
    section("Cut surface knife", {"Shape = plane", "Point [m] = " + middle + ", " + middle + ", " + middle,
                                  "Normal [1] = 1, 1, 1"}) +
    observe("crumbs, pieces, load forces"));
  Timings seconds;
  for (int step = 1; step <= world.n_steps; ++step)
    advance(world, step, seconds);
  return world;
}

double force_z(const World& world) {
  const Body& body = world.bodies[0];
  return dynamics::load_force(*body.loads.acting[0], body.state)[2];
}

/// Dust gets nothing of what acts on surfaces, and crumbs of more material do.
TEST(LightLoads, DustBearsNone) {
  const std::string traction = section("Traction load", {"Traction [N/m^2] = 0; 0; 100"}),
                    pressure = section("Pressure load", {"Pressure [Pa] = 100"});
  constexpr double skin = 0.24; // of the cube [m^2]
  for (const std::string& load : {traction, pressure}) {
    const World dust = without_corner(0.03, "0.1, 0.1, 0.1", load);
    ASSERT_EQ(value(dust.bodies[0], "crumbs"), 1);
    EXPECT_EQ(dust.bodies[0].state.crumbs[0].v, Vec3(Vec3::Zero()));
    EXPECT_EQ(dust.bodies[0].state.crumbs[0].spin, Vec3(Vec3::Zero()));
    const World crumb = without_corner(0.07, "0.5, 0.5, 0.5", load);
    ASSERT_EQ(value(crumb.bodies[0], "crumbs"), 1);
    EXPECT_GT(crumb.bodies[0].state.crumbs[0].v.norm(), 1e-2);
    if (load == traction) {
      EXPECT_NEAR(force_z(dust), 100 * (skin - 1.5 * 0.03 * 0.03), 1e-9);
      EXPECT_NEAR(force_z(crumb), 100 * skin, 1e-9);
    }
  }
}

} // namespace
} // namespace kerf::scene::light_loads_test
