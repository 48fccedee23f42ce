// Bodies that fly: what solvers leave must not depend on how fast they fly, nor be taken for energy or for an error of
// time.

#include "tests/scene/trials.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace kerf::scene::free_fall_test {
namespace {

/// A ball whose skin leaves near-empty cubes.
std::string ball(const std::string& integrator, const std::string& inside = "") {
  return section("Body ball",
                 {"Shape = ball", "Centre [m] = 0.01, 0.02, 0", "Radius [m] = 0.1", "Cube edge [m] = 0.03",
                  "Integrator = " + integrator},
                 material(5e4, 0.4, "corotational") + inside);
}

std::string fall(const double dt, const int n) { return steps(dt, n) + "subsection Gravity\nend\n"; }

/// Two halves that fall side by side, in no strain but round-off. What Newton's method leaves is no gain of energy:
/// taken for one, it had two of three such steps taken again.
TEST(FreeFall, OfACutBodyTakesNoStepAgain) {
  const std::string cut = section(
    "Cut surface plane",
    {"Time [s] = 0.02", "Shape = plane", "Point [m] = 0.012, 0, 0", "Normal [1] = 1, 0.1, 0"});
  for (const std::string integrator : {"Newmark", "generalised alpha", "BDF2"}) {
    World world = world_of(fall(0.005, 60) + ball(integrator) + cut);
    Timings seconds;
    int n_again = 0;
    for (int step = 1; step <= 60; ++step) {
      advance(world, step, seconds);
      n_again += world.bodies[0].report.n_rejected > 0 ? 1 : 0;
    }
    EXPECT_EQ(value(world.bodies[0], "pieces"), 2);
    EXPECT_LE(n_again, 2) << integrator;
  }
}

/// With defaults: errors of corners of hardly any mass, which solvers leave, were taken for errors of time, and
/// substeps fell below the shortest.
TEST(FreeFall, IsFollowedByAdaptiveSteps) {
  for (const std::string integrator : {"implicit Euler", "Newmark", "generalised alpha", "BDF2"}) {
    World world = world_of(fall(0.005, 4) + ball(integrator, section("Adaptive step", {})));
    const auto lowest = [&] {
      return std::ranges::min(world.bodies[0].state.x, {}, [](const Vec3& p) { return p[2]; })[2];
    };
    const double start = lowest(), t = 0.02;
    Timings seconds;
    for (int step = 1; step <= 4; ++step) {
      ASSERT_NO_THROW(advance(world, step, seconds)) << integrator;
      EXPECT_LT(world.bodies[0].report.n_substeps + world.bodies[0].report.n_rejected, 40) << integrator;
    }
    EXPECT_NEAR(start - lowest(), 0.5 * 9.81 * t * t, 1e-3 * t) << integrator;
  }
}

/// Nor do corners of hardly any mass that cuts throw, in a bar that two blades part while it sags: their own motion is
/// faster than any substep.
TEST(AdaptiveSteps, FollowABarThatIsCut) {
  const auto blade = [](const std::string& name, const std::string& edge, const std::string& positions) {
    return section("Blade " + name, {"Edge [m] = " + edge, "Times [s] = 0, 0.2", "Positions [m] = " + positions});
  };
  for (const std::string integrator : {"implicit Euler", "BDF2"}) {
    World world = world_of(
      steps(0.01, 20) + "subsection Gravity\nend\n" +
      section("Body bar",
              {"Shape = box", "Sides [m] = 0.6, 0.3, 0.3", "Cube edge [m] = 0.06", "Integrator = " + integrator},
              material(6e4, 0.3) + section("Support wall", box("-0.4, -1, -1", "-0.2, 1, 1")) +
                section("Adaptive step", {"Error tolerance [m/s] = 0.01"})) +
      blade("down", "0, -1, 0; 0, 1, 0", "0.1, 0, 0.4; 0.1, 0, -0.4") +
      blade("along", "0, -1, 0; 0, 1, 0", "0.5, 0, 0.03; -0.5, 0, 0.03") +
      blade("across", "-0.3, 0, -1; 0.3, 0, 1", "0.05, 0.5, 0; 0.05, -0.5, 0"));
    Timings seconds;
    int n_substeps = 0;
    for (int step = 1; step <= 20; ++step) {
      ASSERT_NO_THROW(advance(world, step, seconds)) << integrator;
      n_substeps += world.bodies[0].report.n_substeps + world.bodies[0].report.n_rejected;
    }
    EXPECT_GE(value(world.bodies[0], "pieces"), 4) << integrator;
    EXPECT_LT(n_substeps, 2000) << integrator;
    std::printf("%s: %d substeps\n", integrator.c_str(), n_substeps);
  }
}

/// What is left by conjugate gradients is measured by what strains a body, not by how fast it flies.
TEST(FreeFall, TrembleAsTheyDoAtRest) {
  const std::string wave = section("Initial state", {"Displacement [m] = .004*sin(30*y); 0; .004*sin(30*x)"});
  for (const std::string integrator : {"implicit Euler", "Newmark", "BDF2"}) {
    const std::string scene = steps(0.002, 10) + ball(integrator, wave);
    World stands = world_of(scene), flies = world_of(scene);
    const Vec3 velocity(0, 0, 500);
    for (Vec3& v : flies.bodies[0].state.v)
      v += velocity;
    Timings seconds;
    for (int step = 1; step <= 10; ++step) {
      advance(stands, step, seconds);
      advance(flies, step, seconds);
    }
    double apart = 0;
    for (std::size_t i = 0; i < stands.bodies[0].state.x.size(); ++i)
      apart = std::max(apart,
                       (flies.bodies[0].state.x[i] - 0.02 * velocity - stands.bodies[0].state.x[i]).norm());
    EXPECT_LT(apart, 4e-5) << integrator;
    std::printf("%s: %.1e m apart\n", integrator.c_str(), apart);
  }
}

/// A turn is no strain, whatever the step's length: asked for at both ends of a step, damping had taken 2 % of the
/// energy in these steps, by the book alone.
TEST(FreeFall, OfASpinIsDampedByNothing) {
  World world = world_of(steps(0.002, 100) + observe("dissipated energy, missing energy") +
                         section("Body bar",
                                 {"Shape = box", "Sides [m] = 0.2, 0.06, 0.06", "Cube edge [m] = 0.02",
                                  "Integrator = Newmark"},
                                 material(1e5, 0.3, "corotational") +
                                   section("Damping", {"Stiffness damping [s] = 0.01"}) +
                                   section("Initial state", {"Velocity [m/s] = -8*y; 8*x; 0"})));
  const double energy = value(world.bodies[0], "kinetic energy");
  Timings seconds;
  for (int step = 1; step <= 100; ++step)
    advance(world, step, seconds);
  EXPECT_LT(value(world.bodies[0], "dissipated energy"), 0.01 * energy);
  EXPECT_NEAR(value(world.bodies[0], "missing energy"), 0, 0.002 * energy);
}

/// Two halves of a cylinder that spins, with damping that acts over many steps: corners of hardly any mass, led by
/// others, made it give 1 % of the energy within these.
TEST(FreeFall, OfACutBodyGainsNothingByDamping) {
  World world = world_of(
    steps(0.001, 150) + observe("dissipated energy, missing energy") +
    section("Cut surface plane",
            {"Time [s] = 0.02", "Shape = plane", "Point [m] = 0, 0.004, 0", "Normal [1] = 0, 1, 0"}) +
    section("Body can",
            {"Shape = cylinder", "Radius [m] = 0.06", "Height [m] = 0.16", "Axis [1] = 1, 0, 0",
             "Cube edge [m] = 0.015", "Centre [m] = 0, 0, 0.0565", "Integrator = Newmark"},
            material(1e5, 0.3, "corotational") + section("Damping", {"Stiffness damping [s] = 0.01"}) +
              section("Initial state", {"Velocity [m/s] = 0; -10*z; 10*y"})));
  Body& body = world.bodies[0];
  Timings seconds;
  double before = value(body, "kinetic energy");
  const double first = before;
  for (int step = 1; step <= 150; ++step) {
    advance(world, step, seconds);
    const double energy = value(body, "kinetic energy") + value(body, "elastic energy");
    if (step > 25) { // the cut is done, and what it gave
      EXPECT_LT(energy, before + 1e-5 * first) << step;
    }
    before = energy;
  }
  EXPECT_EQ(value(body, "pieces"), 2);
}

} // namespace
} // namespace kerf::scene::free_fall_test
