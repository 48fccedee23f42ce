// Books of energy where loads follow a body that turns, and where light corners are damped; blades that bodies come to.

#include "tests/scene/trials.h"

namespace kerf::scene::books_test {
namespace {

std::string turned_box(const Keys& keys, const std::string& inside) {
  return section("Body b",
                 Keys{"Shape = box", "Sides [m] = 0.3, 0.1, 0.1", "Rotation [degrees] = 11, 7, 23",
                      "Cube edge [m] = 0.025"} +
                   keys,
                 material(1e5, 0.25) + inside);
}

std::string knife(const double time) {
  return section("Cut surface knife", {key("Time [s]", time), "Shape = plane", "Point [m] = 0.031, 0.007, 0.003",
                                       "Normal [1] = 1, 0.2, 0.1"});
}

/// A constant pressure on a body that turns does -p times the change of its volume, in steps that follow a cut too; one
/// that grows does the integral of that, here half of it.
TEST(Books, OfAPressureOnABodyThatTurns) {
  const std::string spin = section("Initial state", {"Velocity [m/s] = -10*y; 10*x; 0"});
  for (const std::string integrator : {"Newmark", "generalised alpha", "implicit Euler"}) {
    SCOPED_TRACE(integrator);
    for (const std::string backend : {"fem", "mass-spring"}) {
      SCOPED_TRACE(backend);
      const Trial cut(
        steps(0.005, 60) +
        turned_box({"Integrator = " + integrator, "Backend = " + backend},
                    spin + section("Pressure all", {"Faces = all", "Pressure [Pa] = 2000"})) +
        knife(0.1) + observe("work of loads, volume, pieces"));
      EXPECT_EQ(cut.last("pieces"), 2);
      const auto volume = cut.series("volume");
      const double expected = 2000 * (volume.front() - volume.back());
      EXPECT_GT(expected, 0.05);
      EXPECT_NEAR(cut.last("work of loads"), expected, 0.05 * expected);
    }
  }
}

/// What the damping of light corners takes is dissipated, and that is little of what a body vibrates with: of corners
/// that ring far out.
TEST(Books, CloseWhereLightCornersAreDamped) {
  const Trial cut(
    steps(5e-4, 1000) +
    section("Body b",
            Keys{"Shape = box", "Sides [m] = 0.25, 0.1, 0.08", "Rotation [degrees] = 10, -15, 5",
                 "Cube edge [m] = 0.025", "Integrator = velocity Verlet"},
            material(3e4, 0.4) + section("Initial state", {"Velocity [m/s] = x; 0; z"})) +
    section("Cut surface knife",
            {"Time [s] = 0.02", "Shape = plane", "Point [m] = 0.012, 0.005, 0.004", "Normal [1] = 1, 0.1, 0.05"}) +
    observe("kinetic energy, elastic energy, dissipated energy, missing energy, work of the cut, pieces"));
  EXPECT_GE(cut.last("pieces"), 2);
  const double had = cut.series("kinetic energy").front();
  EXPECT_GT(cut.last("dissipated energy"), 1e-3 * had);
  EXPECT_LT(cut.last("dissipated energy"), 0.1 * had);
  EXPECT_NEAR(cut.last("missing energy"), 0, 5e-3 * had);
}

/// A body may come to its knife: it falls, is thrown or is carried there.
TEST(Books, BodiesMayComeToTheirKnives) {
  const std::string blade = section("Blade knife", {"Edge [m] = -1, 0, 0; 1, 0, 0", "Times [s] = 0.9, 1",
                                                    "Positions [m] = 0, -0.5, -4; 0, 0.5, -4"});
  const auto with = [&](const std::string& inside, const std::string& beside = "") {
    return steps(0.01, 100) + turned_box({}, inside) + beside + blade;
  };
  EXPECT_THROW(world_of(with("")), ParameterError);
  EXPECT_THROW(world_of(with("", section("Gravity", {"Acceleration [m/s^2] = 0, 0, -0.5"}))), ParameterError);
  EXPECT_NO_THROW(world_of(with("", section("Gravity", {}))));
  const std::string sideways = section("Gravity", {"Acceleration [m/s^2] = -9.81, 0, 9.81"});
  EXPECT_THROW(world_of(with("", sideways)), ParameterError) << "it falls elsewhere";
  EXPECT_NO_THROW(world_of(with(section("Initial state", {"Velocity [m/s] = 0; 0; -4"}))));
  EXPECT_NO_THROW(world_of(
    with(section("Support hand", box("-1, -1, -1", "0, 1, 1") + Keys{"Displacement [m] = 0; 0; -4*t"}))));
}

} // namespace
} // namespace kerf::scene::books_test
