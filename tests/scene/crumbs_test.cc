// Dust in scenes: what it keeps in flight, what it costs, and what is said of it.

#include "physics/crumbs.h"
#include "tests/scene/trials.h"

#include <Eigen/Geometry>

namespace kerf::scene::crumbs_test {
namespace {

constexpr double edge = 0.04; // of the cubes of a cube of five nodes across [m]

/// Planes between all nodes, at the first step.
std::string grind() {
  std::string text;
  int n = 0;
  for (const std::string normal : {"1, 0, 0", "0, 1, 0", "0, 0, 1"})
    for (const double at : {-0.06, -0.02, 0.02, 0.06}) {
      std::string point = normal;
      point.replace(point.find('1'), 1, to_text(at));
      text += section("Cut surface plane_" + std::to_string(n++),
                      {"Time [s] = 0.01", "Shape = plane", "Point [m] = " + point, "Normal [1] = " + normal});
    }
  return text;
}

std::string cube_of(const std::string& backend, const std::string& inside = "") {
  return section("Body b", Keys{"Mesh = " + mesh_path("cube.off"), key("Cube edge [m]", edge), "Backend = " + backend},
                 material(2e4, 0.4) + inside);
}

const Keys backends = {"fem", "lattice", "mass-spring", "pba"};

std::string gravity() { return section("Gravity", {"Acceleration [m/s^2] = 0, 0, -9.81"}); }

/// A cube is ground to 125 crumbs, which are thrown and turned. From then on momentum, angular momentum and energy stay
/// what they are, to round-off; the solver has nothing to do.
TEST(CrumbsScene, DustInFlightKeepsAllThatItHas) {
  for (const auto& backend : backends) {
    World world = world_of(steps(0.01, 60) + cube_of(backend) + grind());
    Body& body = world.bodies[0];
    Timings seconds;
    advance(world, 1, seconds);
    advance(world, 2, seconds);
    ASSERT_EQ(value(body, "pieces"), 125) << backend;
    ASSERT_EQ(value(body, "crumbs"), 125) << backend;
    EXPECT_NEAR(value(body, "mass"), 8, 1e-9);
    const Vec3 omega(3, -4, 5);
    for (std::size_t b = 0; b < body.state.crumbs.size(); ++b) {
      body.state.crumbs[b].v = Vec3(1, 0, 2) + omega.cross(body.state.crumbs[b].x);
      body.state.crumbs[b].spin = body.physics->crumbs().body(b).inertia * omega;
    }
    std::map<std::string, double> before;
    for (const std::string name : {"kinetic energy", "momentum x", "momentum y", "momentum z", "angular momentum x",
                                   "angular momentum y", "angular momentum z"})
      before[name] = value(body, name);
    EXPECT_NEAR(before["momentum z"], 16, 0.2);
    for (int step = 3; step <= world.n_steps; ++step) {
      advance(world, step, seconds);
      EXPECT_EQ(body.report.n_iterations, 0) << backend;
    }
    for (const auto& [name, is] : before)
      EXPECT_NEAR(value(body, name), is, 1e-11 * before["kinetic energy"]) << backend << ", " << name;
    for (const Vec3& x : positions(body))
      EXPECT_LT(x.norm(), 5);
  }
}

/// Books close: in gravity, with damping, beside a part that is held, to what implicit Euler loses in the first step.
TEST(CrumbsScene, BooksCloseWithDust) {
  const std::string held =
    section("Support wall", box("-1, -1, 0.05", "1, 1, 1")) + section("Damping", {"Mass damping [1/s] = 2"});
  const Trial dust(steps(0.01, 50) + gravity() + cube_of("fem", held) + grind() +
                   observe("missing energy, kinetic energy, gravity energy, dissipated energy, crumbs, reactions, "
                           "work of supports, mass"));
  EXPECT_EQ(dust.last("crumbs"), 125);
  const auto missing = dust.series("missing energy"), dissipated = dust.series("dissipated energy");
  EXPECT_GT(dissipated.back(), 1);
  const auto work = dust.series("work of supports");
  EXPECT_NEAR(work.back(), work[2], 1e-9 * dissipated.back()) << "what is held at rest costs nothing";
  EXPECT_NEAR(missing.back() - missing[2], 0, 2e-3 * dissipated.back()) << "trapezoidal rule of what is dissipated";
  EXPECT_NEAR(dust.last("reaction wall z"), 2 * 8.0 / 5 * 9.81, 0.01 * 8 * 9.81)
    << "of two layers, whose corners it holds";
}

/// In statics what nothing holds stays where it is.
TEST(CrumbsScene, StaticsLeavesDustWhereItIs) {
  const Trial dust(steps(0.01, 3) + gravity() +
                   section("Body b", Keys{"Mesh = " + mesh_path("cube.off"), key("Cube edge [m]", edge)} + statics(),
                           material(2e4, 0.4) + section("Support wall", box("-1, -1, 0.05", "1, 1, 1"))) +
                   grind() + observe("largest displacement, crumbs, kinetic energy"));
  EXPECT_EQ(dust.last("crumbs"), 125);
  EXPECT_EQ(dust.last("kinetic energy"), 0);
  EXPECT_LT(dust.last("largest displacement"), 0.02);
}

/// A floor stops dust, whatever moves it: it lies on it at the end, with all of its weight.
TEST(CrumbsScene, DustLandsOnAFloor) {
  const std::string floor =
    section("Floor ground", {"Point [m] = 0, 0, -0.15", "Stiffness [N/m^3] = 1e7", "Friction [1] = 0"});
  for (const std::string backend : {"fem", "mass-spring"}) {
    const Trial dust(steps(0.01, 120) + gravity() + cube_of(backend, section("Damping", {"Mass damping [1/s] = 4"})) +
                     floor + grind() + observe("crumbs, kinetic energy, load forces, mass, volume"));
    EXPECT_EQ(dust.last("crumbs"), 125);
    EXPECT_LT(dust.last("kinetic energy"), 1e-3) << backend;
    EXPECT_NEAR(dust.last("force of ground z"), 8 * 9.81, 0.02 * 8 * 9.81) << backend;
  }
}

} // namespace
} // namespace kerf::scene::crumbs_test
