// No step lies: what a spin keeps, what long steps and soft bodies come to, and what rest costs.

#include "base/error.h"
#include "dynamics/forces.h"
#include "dynamics/generalised_alpha.h"
#include "dynamics/quantities.h"
#include "scene/soundness.h"
#include "tests/scene/trials.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <random>

namespace kerf::scene::sound_steps_test {
namespace {

void spin(Body& body, const Vec3& rate) {
  for (std::size_t i = 0; i < body.state.x.size(); ++i)
    body.state.v[i] = rate.cross(body.state.x[i]);
}

Vec3 angular_momentum(const Body& body) {
  return dynamics::angular_momentum(body.physics->model(), body.state, Vec3::Zero());
}

void run_quietly(World& world) {
  const output::TemporaryFolder folder;
  run_silently(world, folder / "out");
}

std::string why_it_fails(World& world) {
  try {
    run_quietly(world);
  } catch (const NumericalError& error) {
    return error.what();
  }
  return "";
}

/// Implicit Euler takes (w dt)^2 of an angular momentum in each step, as 1 / (1 + (w dt)^2) of a turning point mass
/// shows. With 4 rad/s, 1/60 s and 54 steps that leaves 82 %, and so does one solution a step.
TEST(SoundScene, ASpinLosesWhatTheMethodTakesAndNoMore) {
  const double dt = 1.0 / 60, end = 0.9;
  double left = 4;
  for (int i = 0; i < 54; ++i)
    left /= 1 + left * left * dt * dt;
  const auto kept = [&](const std::string& backend, const std::string& law, const double youngs_modulus) {
    World world =
      world_of(steps(dt, static_cast<int>(std::lround(end / dt))) +
               section("Body b", cube_keys() + Keys{"Backend = " + backend}, material(youngs_modulus, 0.4, law)));
    spin(world.bodies[0], {0, 0, 4});
    const double before = angular_momentum(world.bodies[0])[2];
    run_quietly(world);
    return angular_momentum(world.bodies[0])[2] / before;
  };
  for (const double youngs_modulus : {2e4, 1e6}) {
    for (const std::string law : {"corotational", "St. Venant-Kirchhoff", "neo-Hookean"})
      EXPECT_NEAR(kept("fem", law, youngs_modulus), left / 4, 0.003) << law << ", " << youngs_modulus;
    EXPECT_NEAR(kept("pba", "corotational", youngs_modulus), left / 4, 0.003) << "points, " << youngs_modulus;
  }
}

/// A soft cube that turns by a third of a radian a step: where corrections are mixed, each takes fewer iterations of
/// conjugate gradients, and they come to the same places.
TEST(SoundScene, MixedCorrectionsTakeFewerIterationsWhereABodyTurns) {
  World world = world_of(cube_scene());
  Body& body = world.bodies[0];
  spin(body, {0, 0, 16});
  auto& model = dynamic_cast<dynamics::ElasticModel&>(body.physics->model());
  const auto run = [&](const dynamics::NewtonOptions& options, dynamics::State& state) {
    dynamics::GeneralisedAlpha stepper(model, dynamics::generalised_alpha(0.8), options);
    int n = 0;
    for (int i = 0; i < 20; ++i)
      n += stepper.step(state, {}, 0.02).n_iterations;
    return n;
  };
  const dynamics::NewtonOptions usual = dynamics::converged_newton().options();
  dynamics::NewtonOptions without = usual;
  without.n_mixed = 0;
  dynamics::State mixed = body.state, plain = body.state;
  const int n_mixed = run(usual, mixed), n_plain = run(without, plain); // 446 and 823
  EXPECT_LT(n_mixed, 0.75 * n_plain);
  for (std::size_t i = 0; i < mixed.x.size(); ++i)
    EXPECT_LT((mixed.x[i] - plain.x[i]).norm(), 1e-4 * 0.2) << i; // of its edge
}

/// Three blades cross in a cube of points and leave parts that single pairs hold together: those that come back when a
/// cut takes others away bring hardly any energy, as they are stretched least. By their length at rest alone one of
/// them brought half of all there was.
TEST(SoundScene, PairsThatHoldPointsTogetherBringNoEnergy) {
  const auto blade = [](const std::string& name, const std::string& edge, const double from, const double to,
                        const std::string& positions) {
    return section("Blade " + name,
                   {"Edge [m] = " + edge, "Times [s] = " + to_text(from / 60) + ", " + to_text(to / 60),
                    "Positions [m] = " + positions});
  };
  const std::string support =
    section("Support held", {"Region = half space", "Plane normal [1] = 0.41231, -0.48931, -0.76849",
                             "Plane point [m] = -0.0029528, 0.0035042, 0.0055037"});
  const Trial cube(steps(1.0 / 60, 12) + section("Gravity", {"Acceleration [m/s^2] = 5.4, -2.31, 7.86"}) +
                   section("Body b",
                           {"Mesh = " + mesh_path("cube.off"), "Mesh unit [m] = 0.1190755", "Cube edge [m] = 0.002887",
                            "Lattice offset [1] = 0.29244, 0.79352, 0.94975", "Backend = pba"},
                           material(1.4e4, 0.024) + section("Damping", {"Mass damping [1/s] = 2"}) + support) +
                   blade("a", "-0.0253656, -0.0085118, 0.0017351; 0.0253656, 0.0085118, -0.0017351", 0, 8,
                         "-0.0055612, 0.0199378, 0.0168447; 0.0056582, -0.0203407, -0.0167301") +
                   blade("b", "-0.0063551, -0.0078156, 0.0017566; 0.0063551, 0.0078156, -0.0017566", 1, 14,
                         "0.0216865, -0.0123630, 0.0151591; -0.0043460, 0.0047087, -0.0030659") +
                   blade("c", "0.0034346, -0.0071334, -0.0109932; -0.0034346, 0.0071334, 0.0109932", 0, 13,
                         "-0.0256818, -0.0071032, -0.0044703; 0.0258680, 0.0052542, 0.0036166") +
                   observe("work of the cut, elastic energy, kinetic energy"));
  const auto work = cube.series("work of the cut"), elastic = cube.series("elastic energy"),
             kinetic = cube.series("kinetic energy");
  for (std::size_t i = 1; i < work.size(); ++i)
    EXPECT_LT(work[i] - work[i - 1], 0.15 * (elastic[i] + kinetic[i])) << "step " << i;
}

/// A bar is cut in two in flight. Its long piece is drawn out as fast as one correction tells rightly; the short one
/// turns by half a radian in a step, and keeps its volume all the same.
TEST(SoundScene, AShortPieceTurnsBesideALongOneThatSwings) {
  World world =
    world_of(steps(1.0 / 60, 3) + section("Body bar", bar_keys(), material(1e6, 0)) +
             section("Cut surface through", {"Shape = plane", "Point [m] = 0.83, 0, 0", "Normal [1] = 1, 0, 0"}) +
             observe("volume, rest volume, pieces"));
  Body& body = world.bodies[0];
  Timings timings;
  advance(world, 1, timings);
  const auto piece = grid::corner_pieces(body.solid.complex);
  const Points& at_rest = body.physics->rest();
  const auto end = std::ranges::max_element(at_rest, {}, [](const Vec3& p) { return p[0]; }) - at_rest.begin();
  const auto is_short = [&](const std::size_t corner) { return piece[corner] == piece[static_cast<std::size_t>(end)]; };
  for (std::size_t i = 0; i < at_rest.size(); ++i) {
    const Vec3 from = at_rest[i] - Vec3(0.92, 0, 0);
    body.state.v[i] = is_short(i) ? Vec3(0, 30, 0).cross(from) : Vec3(60 * (from[0] + 0.5), 0, 0);
  }
  advance(world, 2, timings);
  double volume = 0, rest = 0;
  for (std::size_t t = 0; t < body.surface.triangles.size(); ++t)
    if (is_short(body.solid.complex.copies[body.surface.copies[t]].corners[0].value)) {
      const auto& [a, b, c] = body.surface.triangles[t];
      volume += positions(body)[a].dot(positions(body)[b].cross(positions(body)[c])) / 6;
      rest += body.surface.rest[a].dot(body.surface.rest[b].cross(body.surface.rest[c])) / 6;
    }
  EXPECT_NEAR(volume / rest, 1, 0.02);
}

/// A bar let go in steps that are far too long for it sags, and keeps its volume.
TEST(SoundScene, LongStepsKeepTheVolume) {
  for (const double g : {0.981, 9.81}) {
    const Trial bar(steps(0.3, 10) + section("Gravity", {"Acceleration [m/s^2] = 0, 0, " + to_text(-g)}) +
                    section("Body bar", bar_keys(),
                            material(1e5, 0.3) + section("Damping", {"Mass damping [1/s] = 2"}) + clamped_end()) +
                    observe("volume, rest volume, solver iterations"));
    const auto now = bar.series("volume"), rest = bar.series("rest volume");
    for (std::size_t i = 0; i < now.size(); ++i)
      EXPECT_NEAR(now[i] / rest[i], 1, 0.03) << "gravity " << g << ", step " << i;
  }
}

/// Weight that its law cannot bear turns a body inside out: it is told, and where.
TEST(SoundScene, ABodyThatTurnsInsideOutEndsTheRun) {
  World world = world_of(steps(1.0 / 60, 240) + section("Gravity", {"Acceleration [m/s^2] = 0, 0, -9.81"}) +
                         section("Body bar", bar_keys(),
                                 material(100, 0.3) + clamped_end() + section("Damping", {"Mass damping [1/s] = 2"})));
  const std::string why = why_it_fails(world);
  EXPECT_NE(why.find("body bar, step "), std::string::npos) << why;
  EXPECT_NE(why.find("rests a"), std::string::npos) << why;
  EXPECT_EQ(why.find("sliver"), std::string::npos) << why;
}

/// Drawn out to 20 times its length it may be rubber, to 40 it is nothing; volume and sides tell nothing of that.
TEST(SoundScene, ACopyDrawnOutEndsTheRun) {
  for (const std::string backend : {"fem", "pba"}) {
    World world =
      world_of(steps(1e-3, 1) + section("Body b", cube_keys() + Keys{"Backend = " + backend}, material(1e4, 0.3)));
    Body& body = world.bodies[0];
    const auto draw_out = [&](const double factor) {
      for (std::size_t i = 0; i < body.state.x.size(); ++i)
        body.state.x[i] =
          body.physics->rest()[i].cwiseProduct(Vec3(factor, 1 / std::sqrt(factor), 1 / std::sqrt(factor)));
      follow(body);
      EXPECT_NEAR(largest_stretch(body).factor, factor, 1e-6 * factor) << backend;
      Watch watch;
      require_sound_volume(body, watch, false); // nobody has asked yet
    };
    EXPECT_NO_THROW(draw_out(20)) << backend;
    try {
      draw_out(40);
      ADD_FAILURE() << backend;
    } catch (const NumericalError& error) {
      EXPECT_NE(std::string(error.what()).find("is drawn out to 40 times"), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find("rests around ("), std::string::npos) << error.what();
    }
  }
}

/// Volumes are asked for once corners have come an eighth of a cube; where phyxels lead them, in each step.
TEST(SoundScene, VolumesAreAskedForOnceTheyCanHaveChanged) {
  for (const std::string backend : {"fem", "pba"}) {
    World world =
      world_of(steps(1e-3, 1) + section("Body b", cube_keys() + Keys{"Backend = " + backend}, material(1e4, 0.3)));
    Body& body = world.bodies[0];
    Points& x = body.state.x;
    const double h = body.solid.grid.h();
    const Points before = x;
    const Vec3 way(0, 0.06 * h, 0);
    x[3] += way;
    EXPECT_NEAR(require_sound_motion(body, before, 1e-3), way.norm(), 1e-12);
    for (Vec3& p : x)
      p[0] *= 100;
    follow(body);
    Watch watch{true, 2 * way.norm()};
    if (backend == "fem") {
      EXPECT_NO_THROW(require_sound_volume(body, watch, false));
    } else {
      EXPECT_THROW(require_sound_volume(body, watch, false), NumericalError);
    }
    EXPECT_THROW(require_sound_volume(body, watch, true), NumericalError) << backend;
    watch = {true, 3 * way.norm()};
    EXPECT_THROW(require_sound_volume(body, watch, false), NumericalError) << backend;
    x = before;
    follow(body);
    require_sound_volume(body, watch, true);
    EXPECT_EQ(watch.way, 0);
  }
}

/// What is cut off a bar at small strain, and tumbles, grows with each turn, as that law takes rotations for strains:
/// it is told. With another law it falls as it is.
TEST(SoundScene, SmallStrainThatTurnsEndsTheRun) {
  const auto why = [](const std::string& law) {
    World world = world_of(steps(0.02, 30) + section("Gravity", {"Acceleration [m/s^2] = 0, 0, -9.81"}) +
                           section("Body bar", bar_keys(), material(3e4, 0.3, law) + clamped_end()) +
                           section("Cut surface through", {"Shape = plane", "Point [m] = 0.45, 0, 0",
                                                           "Normal [1] = 1, 0, 0", "Time [s] = 0.2"}));
    return why_it_fails(world);
  };
  const std::string told = why("small strain");
  EXPECT_NE(told.find("takes rotations for strains"), std::string::npos) << told;
  EXPECT_EQ(why("corotational"), "");
}

/// A cube with a spike on each side, of which a ball takes the inside: spikes hang together by webs along the cube's
/// edges that are thinner than the points are apart. They hang nearly as far down as those of elements; where nothing
/// but weak bonds held them, they fell for three times that way.
TEST(SoundScene, PointsHangByThinWebs) {
  const output::TemporaryFolder folder;
  const auto path = folder / "star.off";
  {
    std::ofstream file(path);
    file << "OFF\n14 24 0\n";
    for (int i = 0; i < 8; ++i)
      file << (i & 1 ? 0.125 : -0.125) << ' ' << (i & 2 ? 0.125 : -0.125) << ' ' << (i & 4 ? 0.125 : -0.125) << '\n';
    const int sides[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    for (int side = 0; side < 6; ++side)
      for (int axis = 0; axis < 3; ++axis)
        file << (axis == side / 2 ? (side % 2 ? 0.5 : -0.5) : 0) << (axis < 2 ? ' ' : '\n');
    for (int side = 0; side < 6; ++side)
      for (int k = 0; k < 4; ++k)
        file << "3 " << sides[side][k] << ' ' << sides[side][(k + 1) % 4] << ' ' << 8 + side << '\n';
  }
  const auto stretch = [&](const std::string& backend) {
    const Trial star(
      steps(1.0 / 60, 45) + section("Gravity", {"Acceleration [m/s^2] = 0, 0, -9.81"}) +
      section("Body b", {"Mesh = " + path.string(), "Cube edge [m] = 0.05", "Backend = " + backend},
              material(2e4, 0.4) + section("Support held", {"Region = half space", "Plane normal [1] = 0, 0, -1",
                                                            "Plane point [m] = 0, 0, 0.25"})) +
      section("Cut surface ball", {"Shape = sphere", "Time [s] = 0.1", "Point [m] = 0, 0, 0", "Radius [m] = 0.16"}) +
      observe("largest stretch, pieces"));
    EXPECT_EQ(star.last("pieces"), 2) << backend;
    return std::ranges::max(star.series("largest stretch"));
  };
  EXPECT_LT(stretch("pba"), 1.5 * stretch("fem"));
}

/// Corners of hardly any mass that a cut has moved follow the others, and do not swing about them.
TEST(SoundScene, LightCornersSwingNoFurtherByBdf2ThanByNewmark) {
  const auto stretch = [](const std::string& integrator) {
    const Trial ball(
      steps(0.005, 80) + section("Gravity", {"Acceleration [m/s^2] = 0, 0, -9.81"}) +
      section("Body b",
              {"Shape = ball", "Radius [m] = 0.25", "Cube edge [m] = 0.06", "Integrator = " + integrator},
              material(2e4, 0.3) + section("Support top", {"Region = half space", "Plane normal [1] = 0, 0, -1",
                                                           "Plane point [m] = 0, 0, 0.15"})) +
      section("Blade k", {"Edge [m] = -1, 0, -0.274; 0, 0, -0.133; 1, 0, 0.274", "Times [s] = 0.05, 0.2",
                          "Positions [m] = 0, -0.4, 0.179; 0, 0.4, 0.096"}) +
      observe("largest stretch, pieces"));
    EXPECT_EQ(ball.last("pieces"), 2) << integrator;
    return ball.last("largest stretch");
  };
  EXPECT_LT(stretch("BDF2"), 1.3 * stretch("Newmark"));
}

TEST(SoundScene, ARunawayCornerEndsTheRun) {
  World world = world_of(steps(1e-3, 1) + section("Body b", cube_keys(), material(1e4, 0.3)));
  Body& body = world.bodies[0];
  const auto before = [&](const double dt) {
    Points x = body.state.x;
    for (std::size_t i = 0; i < x.size(); ++i)
      x[i] -= dt * body.state.v[i];
    return x;
  };
  EXPECT_NO_THROW(require_sound_motion(body, before(1e-3), 1e-3));
  spin(body, {0, 0, 40});
  EXPECT_NO_THROW(require_sound_motion(body, before(1), 1)); // fast, all of it
  spin(body, {0, 0, 0});
  const auto mass = body.physics->model().lumped_mass();
  const auto lightest = static_cast<std::size_t>(std::min_element(mass.begin(), mass.end()) - mass.begin());
  ASSERT_LT(mass[lightest], 1000 * std::pow(body.solid.grid.h(), 3) / 16);
  body.state.v[lightest] = Vec3(500, 0, 0);
  EXPECT_NO_THROW(require_sound_motion(body, before(1e-3), 1e-3)) << "back to where its cubes would have it";
  body.state.x[lightest] += 1e-3 * body.state.v[lightest];
  EXPECT_THROW(require_sound_motion(body, before(1e-3), 1e-3), NumericalError);
  body.state.v[lightest][1] = std::nan("");
  EXPECT_THROW(require_sound_motion(body, before(1e-3), 1e-3), NumericalError);
}

/// With no load there is nothing to solve for, with or without a support.
TEST(SoundScene, ABodyAtRestCostsNothing) {
  for (const std::string& held : {std::string(), clamped_end()})
    for (const std::string law : {"corotational", "neo-Hookean"}) {
      const Trial bar(steps(1.0 / 60, 5) + section("Body bar", bar_keys(), material(1e6, 0.45, law) + held) +
                      observe("solver iterations, kinetic energy"));
      for (const double n : bar.series("solver iterations"))
        EXPECT_EQ(n, 0) << law << held;
      EXPECT_LT(bar.last("kinetic energy"), 1e-18);
    }
}

/// Under its weight it settles, and then costs nothing either; it hangs as far down as statics says.
TEST(SoundScene, ABodyThatHasSettledCostsNothing) {
  const std::string body = material(1e5, 0.3) + clamped_end() + section("Damping", {"Mass damping [1/s] = 4"}),
                    gravity = section("Gravity", {"Acceleration [m/s^2] = 0, 0, -0.981"}),
                    names = observe("solver iterations, largest displacement");
  const Trial moving(steps(1.0 / 60, 600) + gravity + section("Body bar", bar_keys(), body) + names),
    still(steps(1, 1) + gravity + section("Body bar", bar_keys() + statics(), body) + names);
  EXPECT_EQ(moving.last("solver iterations"), 0);
  EXPECT_NEAR(moving.last("largest displacement"), still.last("largest displacement"),
              1e-3 * still.last("largest displacement"));
}

/// Nearly incompressible elements: a factorisation solves what conjugate gradients solve.
TEST(SoundScene, DirectSolverBearsPoissonsRatioNearOneHalf) {
  const auto sag = [](const std::string& solver) {
    return Trial(steps(1.0 / 60, 4) + section("Gravity", {"Acceleration [m/s^2] = 0, 0, -0.981"}) +
                 section("Body bar", bar_keys() + Keys{"Element = enhanced"},
                         material(1e5, 0.4999) + clamped_end() +
                           section("Implicit Euler", Keys{"Solver = " + solver, "CG tolerance [1] = 1e-10",
                                                          "CG iterations [1] = 20000"})) +
                 observe("largest displacement"))
      .last("largest displacement");
  };
  const double direct = sag("direct");
  EXPECT_NEAR(direct, sag("conjugate gradients"), 1e-5 * direct);
}

/// Any stiffness, Poisson's ratio, time step and spin: kinetic and elastic energy stay what they were, or the run says
/// why not.
TEST(SoundScene, StrangersKeepTheirEnergyOrAreRefused) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  const auto between = [&](const double a, const double b) { return a * std::pow(b / a, unit(random)); };
  int n_refused = 0;
  for (int k = 0; k < 30; ++k) {
    const std::string law = std::vector<std::string>{"corotational", "St. Venant-Kirchhoff", "neo-Hookean"}[k % 3];
    const double E = between(1e2, 1e9), dt = between(1e-3, 0.3), nu = 0.4999 * unit(random), rate = between(0.1, 50);
    SCOPED_TRACE(law + ", E " + to_text(E) + ", dt " + to_text(dt) + ", nu " + to_text(nu) + ", " + to_text(rate));
    World world = world_of(steps(dt, 8) + section("Body b", cube_keys(), material(E, nu, law)));
    Body& body = world.bodies[0];
    spin(body, rate * Vec3(unit(random), unit(random), 1).normalized());
    const auto energy = [&] {
      return body.physics->model().energy(body.state.x) + dynamics::kinetic_energy(body.physics->model(), body.state.v);
    };
    const double before = energy();
    const double momentum = angular_momentum(body).norm();
    const std::string why = why_it_fails(world);
    n_refused += why.empty() ? 0 : 1;
    EXPECT_LT(energy(), 1.3 * before) << why;
    EXPECT_LT(angular_momentum(body).norm(), 1.3 * momentum) << why;
  }
  EXPECT_LE(n_refused, 3);
}

} // namespace
} // namespace kerf::scene::sound_steps_test
