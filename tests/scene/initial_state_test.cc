// Bodies that start displaced or in motion, against closed forms.

#include "base/error.h"
#include "tests/scene/trials.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kerf::scene::initial_state_test {
namespace {

World thrown(const std::string& backend, const Keys& initial, const Overrides& more = {}) {
  World world = world_of(cube_scene() + "subsection Gravity\nend\n", [&] {
    Overrides all = more;
    all.push_back("Body cube/Backend=" + backend);
    for (const std::string& key : initial)
      all.push_back("Body cube/Initial state/" + key);
    return all;
  }());
  return world;
}

Vec3 centre(Body& body) {
  const auto mass = body.physics->model().lumped_mass();
  Vec3 sum = Vec3::Zero();
  double all = 0;
  for (std::size_t i = 0; i < mass.size(); ++i) {
    sum += mass[i] * body.state.x[i];
    all += mass[i];
  }
  return sum / all;
}

/// Implicit Euler falls by g dt^2 n (n + 1) / 2 in n steps; shape matching as symplectic Euler, alike.
TEST(InitialState, AThrownBodyFliesAsItShould) {
  for (const std::string backend : {"fem", "pba", "lattice", "mass-spring"}) {
    World world = thrown(backend, {"Displacement [m]=0.1; 0.2; 0.3", "Velocity [m/s]=1; -2; 3"});
    Body& body = world.bodies[0];
    const Vec3 start = centre(body);
    const Points& rest = body.physics->rest();
    for (std::size_t i = 0; i < rest.size(); ++i)
      ASSERT_LT((body.state.x[i] - rest[i] - Vec3(0.1, 0.2, 0.3)).norm(), 1e-15) << backend;
    const output::TemporaryFolder folder;
    run_silently(world, folder / "out");
    EXPECT_LT((centre(body) - start - Vec3(0.05, -0.1, 0.15 - 9.81 * 1e-4 * 15)).norm(), backend == "pba" ? 1e-6 : 1e-9)
      << backend; // its linear solver leaves some 1e-7 of the momentum
  }
}

/// A field of velocities w x X is a spin, whose angular momentum is that of a cube.
TEST(InitialState, AVelocityFieldSpinsABody) {
  World world = thrown("fem", {"Velocity [m/s]=-3*y; 3*x; 0"});
  Body& body = world.bodies[0];
  const double mass = value(body, "mass");
  const double momentum = dynamics::angular_momentum(body.physics->model(), body.state, Vec3::Zero())[2];
  EXPECT_NEAR(momentum / (3 * mass * 0.2 * 0.2 / 6), 1 + 2 * std::pow(0.05 / 0.2, 2), 1e-9); // masses are lumped
}

/// What is held stays, and a turned body starts turned.
TEST(InitialState, SupportsHoldWhatTheyHold) {
  World world = thrown("fem", {"Displacement [m]=x*cos(1)-y*sin(1)-x; x*sin(1)+y*cos(1)-y; 0"},
                       {"Body cube/Support left/Lower [m]=-1, -1, -1", "Body cube/Support left/Upper [m]=-0.05, 1, 1"});
  const Body& body = world.bodies[0];
  const Points& rest = body.physics->rest();
  const Mat3 turn = Eigen::AngleAxisd(1, Vec3::UnitZ()).toRotationMatrix();
  std::size_t n_held = 0;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    const bool is_held = rest[i][0] <= -0.05;
    n_held += is_held ? 1 : 0;
    EXPECT_LT((body.state.x[i] - (is_held ? rest[i] : Vec3(turn * rest[i]))).norm(), 1e-15);
  }
  EXPECT_GT(n_held, 10u);
}

/// A cut at time 0 is where it is at rest, however far the body starts from there; and dust starts in motion.
TEST(InitialState, WhatCutsAtTimeZeroCutsTheBodyAtRest) {
  const Overrides plane = {"Cut surface half/Shape=plane", "Cut surface half/Point [m]=0.003, 0, 0",
                           "Cut surface half/Normal [1]=1, 0, 0"};
  World world = thrown("fem", {"Displacement [m]=5; 0; -z", "Velocity [m/s]=1; 0; 0"}, plane);
  Timings seconds;
  advance(world, 1, seconds);
  EXPECT_EQ(grid::n_pieces(world.bodies[0].solid.complex), 2u);
  EXPECT_GT(centre(world.bodies[0])[0], 4.9);

  Overrides dice;
  for (const std::string axis : {"x", "y", "z"})
    for (const std::string place : {"-0.05", "0.0", "0.05"})
      for (const std::string& key : {std::string("Shape=plane"), "Point [m]=" + place + "," + place + "," + place,
                                     "Normal [1]=" + std::string(axis == "x"   ? "1,0,0"
                                                                 : axis == "y" ? "0,1,0"
                                                                               : "0,0,1")})
        dice.push_back("Cut surface " + axis + std::to_string(dice.size() / 3) + "/" + key);
  World dust = thrown("fem", {"Velocity [m/s]=1; 2; 3"}, dice);
  advance(dust, 1, seconds);
  const Body& body = dust.bodies[0];
  ASSERT_EQ(body.physics->crumbs().size(), 64u);
  for (const auto& crumb : body.state.crumbs)
    EXPECT_LT((crumb.v - Vec3(1, 2, 3 - 9.81 * 0.01)).norm(), 1e-9);
}

/// Squeezed flat and turned inside out, an elastic body comes back, and is not taken for a nonsense on its way.
TEST(InitialState, ABodyComesBackFromBeingFlatOrInsideOut) {
  for (const std::string displacement : {"0; 0; -z", "-2*x; 0; 0", "-x; -y; -z"}) {
    World world = thrown("fem", {"Displacement [m]=" + displacement}, {"Time/End time [s]=1"});
    const output::TemporaryFolder folder;
    run_silently(world, folder / "out");
    EXPECT_TRUE(world.watches[0].is_sound) << displacement;
    EXPECT_NEAR(value(world.bodies[0], "volume") / value(world.bodies[0], "rest volume"), 1, 0.01) << displacement;
  }
}

/// A soft ball that nobody cuts and nothing damps: its vibrations come to all corners, and the lightest of its skin are
/// drawn out no further than what the ball itself does. (With their mass and nothing that damps them: 24 to 30 times.)
TEST(InitialState, LightCornersOfAVibratingBodyDoNotRunAway) {
  const std::string initial =
    section("Initial state", {"Velocity [m/s] = sin(120*y); sin(120*z); sin(120*x)"});
  for (const std::string integrator : {"BDF2", "Newmark", "generalised alpha", "symplectic Euler", "velocity Verlet"}) {
    const bool is_explicit = integrator == "symplectic Euler" || integrator == "velocity Verlet";
    const double dt = is_explicit ? 5e-4 : 4e-3;
    const Trial trial(steps(dt, static_cast<int>(std::lround(0.5 / dt))) +
                      section("Body ball",
                              {"Shape = ball", "Radius [m] = 0.0517", "Cube edge [m] = 0.01",
                               "Integrator = " + integrator},
                              material(1e4, 0.4) + initial) +
                      observe("largest stretch"));
    const auto stretch = trial.series("largest stretch");
    EXPECT_LT(std::ranges::max(stretch), 8) << integrator;
    EXPECT_GT(std::ranges::max(stretch), 1.5) << integrator << ": it vibrates";
  }
}

/// In statics nothing resists the motion of a free body: corrections must not be lost in it.
TEST(InitialState, AFreeBodyFindsItsRestInStaticsBesideSlivers) {
  Overrides cuts = {"Body cube/Integrator=quasi-static", "Body cube/Quasi-static/Free modes=allow",
                    "Body cube/Material/Poisson's ratio [1]=0.45"};
  for (int axis = 0; axis < 3; ++axis)
    for (const std::string place : {"-0.02500005", "0.07500005"}) { // a millionth of a cube beside nodes
      const std::string name = "Cut surface at" + std::to_string(cuts.size()) + "/";
      const std::string normal = axis == 0 ? "1, 0, 0" : axis == 1 ? "0, 1, 0" : "0, 0, 1";
      cuts.insert(cuts.end(), {name + "Shape=plane", name + "Point [m]=" + place + "," + place + "," + place,
                               name + "Normal [1]=" + normal});
    }
  World world = thrown("fem", {"Displacement [m]=0.2*x; 0.2*y; 0.2*z"}, cuts);
  world.bodies[0].loads.gravity = Vec3::Zero();
  Timings seconds;
  advance(world, 1, seconds);
  EXPECT_GT(grid::n_pieces(world.bodies[0].solid.complex), 8u);
  EXPECT_NEAR(value(world.bodies[0], "volume") / value(world.bodies[0], "rest volume"), 1, 1e-5);
}

/// What a bar of `n` cubes, free at both ends, sounds: the first wave along it is an eigenvector of the cubes'
/// equations, and Newmark's rule makes a frequency w of tan(w dt / 2) 2 / dt. Returns it over that of the bar, pi c /
/// L.
double tone_of_a_bar(const std::string& mass, const int n) {
  constexpr double dt = 5e-4, side = 1, c = 31.622776601683793;
  const std::string initial = section("Initial state", {"Displacement [m] = 1e-4*cos(pi*x); 0; 0"});
  Trial trial(steps(dt, 400) +
              section("Body bar",
                      {"Shape = box", "Centre [m] = 0.5, 0, 0", "Lattice offset [1] = 0.5, 0.5, 0.5",
                       "Integrator = Newmark", key("Cube edge [m]", side / n), "Mass = " + mass,
                       "Sides [m] = 1, " + to_text(2 * side / n) + ", " + to_text(2 * side / n)},
                      material(1e6, 0, "small strain") + initial + section("Probe end", {"Point [m] = 0.01, 0, 0"})) +
              observe("probes"));
  const auto u = trial.series("probe end x");
  std::vector<double> zeros; // of a straight line between two steps [steps]
  for (std::size_t i = 1; i < u.size(); ++i)
    if ((u[i] < 0) != (u[i - 1] < 0))
      zeros.push_back(static_cast<double>(i) - u[i] / (u[i] - u[i - 1]));
  const double angle = std::numbers::pi * static_cast<double>(zeros.size() - 1) / (zeros.back() - zeros.front());
  return std::tan(0.5 * angle) * 2 / dt / (std::numbers::pi * c / side);
}

/// Closed forms of an endless row of cubes: lumped sin(k h / 2) 2 / h, consistent sqrt(6 (1 - cos k h) / (2 + cos k h))
/// / h, over k; they are 1.3 % apart. The ends of this one lie in the middle of cubes.
TEST(ConsistentMass, ABarHasTheFrequenciesOfItsMassMatrix) {
  constexpr int n = 8;
  const double kh = std::numbers::pi / n;
  EXPECT_NEAR(tone_of_a_bar("lumped", n), std::sin(kh / 2) * 2 / kh, 3e-3);
  EXPECT_NEAR(tone_of_a_bar("consistent", n), std::sqrt(6 * (1 - std::cos(kh)) / (2 + std::cos(kh))) / kh, 3e-3);
}

/// Spin and free flight: the consistent mass of a linear field is exact, and what moves freely is cut in its flight.
TEST(ConsistentMass, KeepsMomentaOfWhatFliesAndIsCut) {
  for (const std::string integrator : {"implicit Euler", "BDF2", "Newmark", "generalised alpha"}) {
    const Overrides more = {"Body cube/Mass=consistent",
                            "Body cube/Integrator=" + integrator,
                            "Cut surface half/Shape=plane",
                            "Cut surface half/Point [m]=0.003, 0, 0",
                            "Cut surface half/Normal [1]=1, 0.2, 0",
                            "Cut surface half/Time [s]=0.02"};
    World world = thrown("fem", {"Velocity [m/s]=1-0.3*y; 0.3*x; 0"}, more);
    Body& body = world.bodies[0];
    body.loads.gravity = Vec3::Zero();
    const double mass = value(body, "mass");
    const auto spin = [&] { return dynamics::angular_momentum(body.physics->model(), body.state, Vec3::Zero()); };
    const bool is_extended = integrator != "implicit Euler"; // to near-empty copies' corners
    EXPECT_NEAR(spin()[2] / (0.3 * mass * 0.04 / 6), 1, is_extended ? 2e-3 : 1e-9) << integrator;
    EXPECT_NEAR(value(body, "kinetic energy") / (0.5 * mass * (1 + 0.09 * 0.04 / 6)), 1, is_extended ? 2e-6 : 1e-9)
      << integrator;
    const double before = spin()[2];
    Timings seconds;
    for (int step = 1; step <= world.n_steps; ++step)
      advance(world, step, seconds);
    EXPECT_EQ(grid::n_pieces(body.solid.complex), 2u);
    EXPECT_NEAR(dynamics::momentum(body.physics->model(), body.state)[0] / mass, 1, 1e-6) << integrator;
    EXPECT_NEAR(spin()[2] / before, 1, is_extended ? 1e-2 : 2e-3) << integrator;
  }
}

TEST(ConsistentMass, IsRefusedWhereNothingReadsIt) {
  const auto refuse = [](const Overrides& more, const std::string& word) {
    Overrides all = more;
    all.push_back("Body cube/Mass=consistent");
    try {
      world_of(cube_scene(), all);
      ADD_FAILURE() << word << " was accepted";
    } catch (const ParameterError& error) {
      EXPECT_NE(std::string(error.what()).find("Mass"), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
    }
  };
  refuse({"Body cube/Integrator=symplectic Euler"}, "symplectic Euler");
  refuse({"Body cube/Integrator=quasi-static"}, "quasi-static");
  for (const std::string backend : {"pba", "lattice", "mass-spring"})
    refuse({"Body cube/Backend=" + backend}, backend);
}

TEST(InitialState, WhatIsNoExpressionIsRefusedWithItsPlace) {
  for (const std::string bad : {"1; 2", "x +; 0; 0", "1/(x-x); 0; 0"})
    try {
      thrown("fem", {"Displacement [m]=" + bad});
      ADD_FAILURE() << bad << " was accepted";
    } catch (const ParameterError& error) {
      EXPECT_NE(std::string(error.what()).find("Displacement"), std::string::npos) << error.what();
    }
}

} // namespace
} // namespace kerf::scene::initial_state_test
