// Scenes that move: every integrator by its name and its section, divided steps, steps that are refused.

#include "base/error.h"
#include "tests/scene/trials.h"

namespace kerf::scene::motion_scenes_test {
namespace {

/// A cube on a clamped foot, which gravity along x swings from rest for 0.1 s.
std::string swinging_cube(const std::string& integrator, const std::string& settings, const double dt,
                          const std::string& names = "probes, momentum x") {
  const std::string inside = material(1e4, 0.3) + section("Support foot", box("-1, -1, -1", "1, 1, -0.06")) +
                             section("Probe top", {"Point [m] = 0, 0, 0.09"}) + settings;
  return steps(dt, static_cast<int>(std::lround(0.1 / dt))) + section("Gravity", {"Acceleration [m/s^2] = 2, 0, 0"}) +
         section("Body cube", cube_keys() + Keys{"Integrator = " + integrator}, inside) + observe(names);
}

const Keys whole_newton = {"Newton iterations [1] = 20", "Newton tolerance [1] = 1e-9", "CG tolerance [1] = 1e-9"};

std::string heading(std::string integrator) {
  integrator[0] = static_cast<char>(std::toupper(integrator[0]));
  return integrator;
}

double swing(const std::string& integrator, const double dt) {
  const bool is_implicit = integrator == "implicit Euler" || integrator == "BDF2" || integrator == "Newmark" ||
                           integrator == "generalised alpha";
  return Trial(swinging_cube(integrator, is_implicit ? section(heading(integrator), whole_newton) : "", dt))
    .last("probe top x");
}

/// What flies as its support does, or turns as it does, is not deformed by steps that take the support on by more than
/// half a cube, of whatever order.
TEST(MotionScene, RidesWithItsSupport) {
  for (const std::string backend : {"fem", "mass-spring", "pba"})
    for (const bool turns : {false, true}) {
      SCOPED_TRACE(backend + (turns ? ", turns" : ""));
      const std::string motion = turns ? "Rotation [degrees] = 0; 0; 300*t" : "Displacement [m] = 0; 0; 3*t";
      const std::string velocity = turns ? "Velocity [m/s] = -5.235988*y; 5.235988*x; 0" : "Velocity [m/s] = 0; 0; 3";
      const Trial cube(steps(0.01, 10) +
                       section("Body cube", cube_keys() + Keys{"Backend = " + backend, "Integrator = implicit Euler"},
                               material(1e4, 0.3) + section("Initial state", {velocity}) +
                                 section("Support foot", box("-1, -1, -1", "1, 1, -0.02") + Keys{motion})) +
                       observe("elastic energy, kinetic energy, work of supports"));
      const auto kinetic = cube.series("kinetic energy"), elastic = cube.series("elastic energy");
      for (std::size_t k = 1; k < elastic.size(); ++k)
        EXPECT_LT(elastic[k], (turns ? 0.02 : 1e-12) * kinetic[k]) << k; // turning, it is drawn out by its weight
      EXPECT_LT(std::abs(cube.last("work of supports")), (turns ? 0.1 : 1e-9) * kinetic.back());
    }
}

TEST(MotionScene, EveryIntegratorSwingsAlike) {
  const double exact = swing("velocity Verlet", 1e-4);
  EXPECT_GT(exact, 0.003);
  struct Case {
    std::string integrator;
    double dt, tolerance;
  };
  const std::vector<Case> cases = {{"implicit Euler", 0.001, 0.04},   {"BDF2", 0.001, 0.003},
                                   {"Newmark", 0.001, 0.001},         {"generalised alpha", 0.001, 0.001},
                                   {"symplectic Euler", 0.001, 0.04}, {"velocity Verlet", 0.001, 0.001},
                                   {"explicit Euler", 1e-4, 0.01},    {"midpoint Runge-Kutta", 0.001, 0.001}};
  for (const Case& c : cases) {
    const double error = swing(c.integrator, c.dt) / exact - 1;
    std::printf("%-20s dt %.0e s: %+.2e\n", c.integrator.c_str(), c.dt, error);
    EXPECT_LT(std::abs(error), c.tolerance) << c.integrator;
  }
}

TEST(MotionScene, AnAdaptiveStepDividesUntilTheErrorIsSmall) {
  const double exact = swing("velocity Verlet", 1e-4);
  double last_error = 1e9, last_substeps = 0;
  for (const double tolerance : {0.01, 1e-4}) {
    const std::string settings =
      section("Newmark", whole_newton) + section("Adaptive step", {key("Error tolerance [m/s]", tolerance)});
    const Trial cube(swinging_cube("Newmark", settings, 0.02, "probes, substeps"));
    const double error = std::abs(cube.last("probe top x") - exact);
    double substeps = 0;
    for (const double n : cube.series("substeps"))
      substeps += n;
    std::printf("tolerance %.0e m/s: %.0f substeps, error %.1e m\n", tolerance, substeps, error);
    EXPECT_LT(error, tolerance * 0.1) << "metres after 0.1 s";
    EXPECT_GT(substeps, last_substeps);
    EXPECT_LT(error, last_error);
    last_error = error;
    last_substeps = substeps;
  }
  EXPECT_GT(last_substeps, 10) << "more than the five steps";
  const std::string settings = section("Newmark", whole_newton);
  const double whole = Trial(swinging_cube("Newmark", settings, 0.02)).last("probe top x");
  EXPECT_GT(std::abs(whole - exact), last_error);
}

/// The number in the message is the truth: a step just below it runs, one just above is refused.
TEST(MotionScene, AStepBeyondTheStableOneIsRefusedWithTheStableOne) {
  for (const std::string integrator : {"symplectic Euler", "velocity Verlet"}) {
    double stable = 0;
    try {
      Trial(swinging_cube(integrator, "", 0.05));
      FAIL() << "ran";
    } catch (const ParameterError& error) {
      const std::string message = error.what();
      EXPECT_NE(message.find("body cube, step 1"), std::string::npos) << message;
      const auto at = message.find("stable");
      ASSERT_NE(at, std::string::npos) << message;
      const auto digit = message.find_first_of("0123456789", at);
      stable = std::stod(message.substr(digit));
      std::printf("%s\n", message.c_str());
    }
    EXPECT_GT(stable, 0.002);
    EXPECT_LT(stable, 0.05);
    const auto first_step = [&](const double dt) {
      World world = world_of(swinging_cube(integrator, "", 0.05), {"Time/Time step [s]=" + to_text(dt)});
      world.n_steps = 1;
      const output::TemporaryFolder folder;
      run_silently(world, folder / "out");
    };
    EXPECT_NO_THROW(first_step(0.995 * stable));
    EXPECT_THROW(first_step(1.005 * stable), ParameterError);
  }
  EXPECT_NO_THROW(
    Trial(swinging_cube("symplectic Euler", section("Symplectic Euler", {"Beyond the stable step = go on"}), 0.05)));
}

} // namespace
} // namespace kerf::scene::motion_scenes_test
