// Scenes whose energy is booked: a cut that grows under load, motion that is driven and damped.

#include "tests/scene/trials.h"

#include <cmath>
#include <cstdio>

namespace kerf::scene::energy_scenes_test {
namespace {

constexpr double E = 1e5, dead_load = 10; // [Pa]

/// A rectangle in the plane z = 0.1 m from x = -1 to `end`, across the whole bar, as a mesh file.
std::string write_front(const std::filesystem::path& path, const double end) {
  std::ofstream(path) << "OFF\n4 2 0\n-1 -1 0.1\n"
                      << end << " -1 0.1\n-1 1 0.1\n"
                      << end << " 1 0.1\n3 0 1 3\n3 0 3 2\n";
  return path.string();
}

/// How far what a bar gives off as its cut grows by a cell is off the closed form, and off the growth of the elastic energy.
struct Released {
  double off_form, off_elastic;
};

/// A bar of two arms of 0.1 m, 3 cells each, opened by dead loads at its end; the cut ends after `end` cells, and grows by
/// one. G = 12 P^2 a^2 / (E b^2 h^3) (1 + 0.64 h/a)^2 (Foote and Buchwald 1985) times b da is released: what is missing in
/// the books, and the growth of the elastic energy, but for what ties at the front hold at the instant of cutting.
Released released(const double end, const std::function<Keys(double end)>& shape) {
  const double cell = 0.1 / 3, b = 0.2, h = 0.1, P = dead_load * b * h;
  const std::string mouth = "0.001, 1, 0.0999";
  const std::string inside =
    material(E, 0.3, "small strain") + section("Support wall", box("0.97, -1, -1", "2, 1, 1")) +
    section("Traction up", box("-1, -1, 0.1", "0.001, 1, 1") + Keys{"Traction [N/m^2] = 0; 0; 10"}) +
    section("Traction down", box("-1, -1, -1", mouth) + Keys{"Traction [N/m^2] = 0; 0; -10"});
  const auto cut_at = [&](const double time, const double n_cells, const std::string& name) {
    return section("Cut surface " + name, Keys{key("Time [s]", time)} + shape(n_cells * cell));
  };
  const Trial bar(
    steps(1, 3) +
    section("Body bar",
            Keys{"Mesh = " + mesh_path("bar.off"), key("Cube edge [m]", cell), "Element = enhanced"} + statics(),
            inside) +
    cut_at(1, end, "start") + cut_at(2, end + 1, "growth") +
    observe("missing energy, elastic energy, energy of loads, work of the cut, load forces, pieces"));
  EXPECT_NEAR(bar.last("force of up z"), P, 1e-9);
  const auto missing = bar.series("missing energy"), elastic = bar.series("elastic energy"),
             at_once = bar.series("work of the cut");
  const double released = missing[3] - missing[2], growth = elastic[3] - elastic[2];
  EXPECT_NEAR(released - (at_once[3] - at_once[2]), growth, 1e-5 * released) << "Clapeyron";
  const double a = (end + 0.5) * cell, G = 12 * P * P * a * a / (E * b * b * h * h * h) * std::pow(1 + 0.64 * h / a, 2);
  std::printf("double cantilever: released %.4g J, %.2f %% off the closed form; the body gained %.4g J\n", released,
              100 * (released / (G * b * cell) - 1), growth);
  return {std::abs(released / (G * b * cell) - 1), std::abs(growth / released - 1)};
}

/// It ends where, with the lag of its front, it has just come through a cell, so that ties hold next to nothing.
TEST(EnergyScene, DoubleCantileverGivesAwayItsEnergyRelease) {
  const auto [off_form, off_elastic] = released(15.25, [](const double end) {
    return Keys{"Shape = rectangle", "Point [m] = 0, 0, 0.1", "First side [m] = " + std::to_string(2 * end) + ", 0, 0",
                "Second side [m] = 0, 2, 0"};
  });
  EXPECT_LT(off_form, 0.02);
  EXPECT_LT(off_elastic, 5e-3) << "enhanced strain of new copies differs a little";
}

/// As a mesh, whose fronts are drawn to a texel, and which moves on those of the one before.
TEST(EnergyScene, DoubleCantileverCutByMeshesGivesAwayItsEnergyRelease) {
  const output::TemporaryFolder folder;
  const auto [off_form, off_elastic] = released(15.3, [&](const double end) {
    return Keys{"Shape = mesh", "Mesh = " + write_front(folder / (std::to_string(end) + ".off"), end)};
  });
  EXPECT_LT(off_form, 0.04);
  EXPECT_LT(off_elastic, 0.03);
}

/// Between grips that stay: released is half the way of the grips times what their force falls by.
TEST(EnergyScene, CutBetweenGripsGivesAwayWhatTheirForceFallsBy) {
  const std::string inside =
    material(E, 0.3, "small strain") + clamped_end() +
    section("Support hand", box("0.93, -1, -1", "2, 1, 1") + Keys{"Displacement [m] = 0.001*min(t, 1); 0; 0"});
  const Trial bar(steps(1, 2) + section("Body bar", bar_keys(5) + statics(), inside) +
                  section("Cut surface notch", {"Time [s] = 1", "Shape = disc", "Point [m] = 0.5, 0.1, 0.2",
                                                "Normal [1] = 1, 0, 0", "Radius [m] = 0.1"}) +
                  observe("missing energy, elastic energy, work of supports, work of the cut, reactions, cut edges"));
  EXPECT_GT(bar.last("cut edges"), 3);
  const auto force = bar.series("reaction hand x"), elastic = bar.series("elastic energy"),
             missing = bar.series("missing energy"), work = bar.series("work of supports");
  EXPECT_NEAR(work[1], 0.5 * force[1] * 0.001, 1e-9 * work[1]);
  EXPECT_NEAR(work[1], elastic[1], 1e-5 * elastic[1]);
  EXPECT_NEAR(missing[1], 0, 1e-5 * elastic[1]);
  EXPECT_NEAR(work[2], work[1], 1e-9 * work[1]);
  EXPECT_LT(force[2], 0.98 * force[1]);
  const double released = 0.5 * 0.001 * (force[1] - force[2]);
  EXPECT_NEAR(missing[2], released, 2e-4 * released);
  EXPECT_NEAR(bar.last("work of the cut"), 0, 1e-6 * released) << "at the instant of cutting nothing moves";
}

/// A lattice rests on a floor while a slow blade parts it. Light corners away from the cut stay where the floor has them:
/// when all of them went to their goals in each step, 4 J of a body of .15 J were booked as the cut's, and missing then.
TEST(EnergyScene, CutOfALatticeOnAFloorGivesNothing) {
  const Trial box(steps(0.002, 350) + section("Gravity", {"Acceleration [m/s^2] = 0, 0, -9.81"}) +
                  section("Floor f", {"Point [m] = 0, 0, -0.2", "Friction [1] = 0"}) +
                  section("Body b",
                          {"Shape = box", "Sides [m] = 0.6, 0.4, 0.4", "Cube edge [m] = 0.05", "Backend = lattice"},
                          material(5e5, 0.4) + section("Damping", {"Mass damping [1/s] = 20"})) +
                  section("Blade k", {"Edge [m] = 0, -0.7, 0; 0, 0.7, 0", "Times [s] = 0.4, 0.7",
                                      "Positions [m] = 0, 0, 0.3; 0, 0, -0.3"}) +
                  observe("missing energy, elastic energy, work of the cut, pieces"));
  EXPECT_EQ(box.last("pieces"), 2);
  const auto missing = box.series("missing energy");
  const double elastic = box.last("elastic energy");
  std::printf("elastic %.4f J, work of the cut %.4f J, missing %.4f J more\n", elastic, box.last("work of the cut"),
              missing.back() - missing[200]);
  EXPECT_LT(std::abs(box.last("work of the cut")), elastic);
  EXPECT_LT(std::abs(missing.back() - missing[200]), elastic);
}

/// All that books know: a support that moves, a pressure, a handle with a damper, gravity, both dampings.
std::string driven_cube(const double dt, const int n) {
  const std::string inside =
    material(1e4, 0.3) + section("Damping", {"Mass damping [1/s] = 2", "Stiffness damping [s] = 1e-3"}) +
    section("Newmark", {"Newton iterations [1] = 20", "Newton tolerance [1] = 1e-10", "CG tolerance [1] = 1e-10"}) +
    section("Support bottom",
            box("-1, -1, -1", "1, 1, -0.06") + Keys{"Displacement [m] = 0.01*(1 - cos(15*t)); 0; 0"}) +
    section("Pressure push", box("-1, -1, 0.09", "1, 1, 1") + Keys{"Pressure [Pa] = 100*(1 - cos(30*t))"}) +
    section("Handle hand", {"Point [m] = 0, 0, 0.08", "Stiffness [N/m] = 20", "Damping [N s/m] = 2"});
  return steps(dt, n) + section("Gravity", {"Acceleration [m/s^2] = 0, 0, -1"}) +
         section("Body cube", cube_keys() + Keys{"Integrator = Newmark"}, inside) +
         observe("missing energy, kinetic energy, elastic energy, dissipated energy, work of supports, work of loads");
}

TEST(EnergyScene, BooksOfADrivenBodyCloseWithTheSquareOfTheStep) {
  const Trial coarse(driven_cube(0.01, 20)), fine(driven_cube(0.005, 40));
  const double a = coarse.last("missing energy"), b = fine.last("missing energy");
  const double moved = fine.last("kinetic energy") + fine.last("elastic energy");
  std::printf("driven cube: missing %.2e, %.2e of the energy there is\n", a / moved, b / moved);
  for (const std::string share : {"dissipated energy", "work of supports", "work of loads"})
    EXPECT_GT(std::abs(fine.last(share)), 10 * std::abs(b)) << share;
  EXPECT_LT(std::abs(b), 0.005 * moved);
  EXPECT_NEAR(b / a, 0.25, 0.1);
}

/// A free cube that quivers: implicit Euler loses what Newmark keeps, and the books say how much.
TEST(EnergyScene, MissingEnergyIsWhatAnIntegratorLoses) {
  const auto missing_share = [](const std::string& integrator) {
    World world = world_of(steps(0.005, 20) +
                           section("Body cube", cube_keys() + Keys{"Integrator = " + integrator}, material(1e4, 0.3)) +
                           observe("missing energy, kinetic energy, elastic energy"));
    set_in_motion(world.bodies[0], Vec3::Zero(), 0.05);
    Body& body = world.bodies[0];
    body.accounts->open(*body.physics, body.loads, body.state);
    const double start = body.accounts->start_energy();
    const output::TemporaryFolder folder;
    run_silently(world, folder / "out");
    const output::Reader reader(folder / "out/run.h5");
    const double missing = reader.observable("cube missing energy").back();
    const double there =
      reader.observable("cube kinetic energy").back() + reader.observable("cube elastic energy").back();
    EXPECT_NEAR(missing, start - there, 1e-12 * start);
    return missing / start;
  };
  EXPECT_GT(missing_share("implicit Euler"), 0.3);
  EXPECT_NEAR(missing_share("Newmark"), 0, 0.02);
}

/// A blade that tilts on its way through a body that falls open about a wall and a handle: no cut gives anything (a
/// front that was taken back closed the gaping wound, and the whole body snapped away from its handle: 215 J for 50 J).
TEST(EnergyScene, ABladeThatTiltsGivesNothing) {
  for (const std::string backend : {"fem", "mass-spring"})
    for (const std::string integrator : {"implicit Euler", "BDF2", "Newmark", "generalised alpha"}) {
      SCOPED_TRACE(backend + ", " + integrator);
      const Trial slab(
        steps(0.01, 40) +
        section("Gravity", {"Acceleration [m/s^2] = 1.683, -2.357, -2.621"}) +
        section("Body b",
                {"Shape = box", "Sides [m] = 0.8, 0.2, 0.5", "Cube edge [m] = 0.1", "Backend = " + backend,
                 "Integrator = " + integrator},
                section("Support w", box("-1.4, -9, -9", "-0.39, 9, 9") + Keys{"Hold at = skin"}) +
                  section("Handle h", {"Point [m] = 0.165, -0.074, 0.113", "Stiffness [N/m] = 995"})) +
        section("Blade k", {"Edge [m] = 0, 0, -0.75; 0, 0, 0.75", "Times [s] = 0, 0.16, 0.4",
                            "Positions [m] = -0.273, 0.23, 0; -0.273, -0.0553, 0; -0.273, -0.23, 0",
                            "Rotations [degrees] = 0, 0, 0; -8.48, 3.66, -19.35; -14.16, -19.74, -3.7"}) +
        observe("work of the cut, kinetic energy, pieces"));
      EXPECT_EQ(slab.last("pieces"), 2);
      const auto work = slab.series("work of the cut"), kinetic = slab.series("kinetic energy");
      const double most = *std::ranges::max_element(kinetic);
      for (std::size_t k = 1; k < work.size(); ++k)
        EXPECT_LT(work[k] - work[k - 1], 0.01 * most) << k;
    }
}

/// Pieces that are too small to be deformed become rigid while a stiff load holds them: it gets nothing by that.
TEST(EnergyScene, ACrumbThatALoadHoldsGivesNothing) {
  const auto check = [](const Keys& body, const std::string& held, const std::string& cuts) {
    const Keys skin = {"Hold at = skin", "Displacement [m] = 0.064*t; -0.09*t; -0.037*t"};
    const Trial block(steps(0.01, 40) +
                      section("Body b", Keys{"Shape = box", "Cube edge [m] = 0.1"} + body,
                              section("Support w", box("-1.2, -9, -9", "-0.19, 9, 9") + skin) + held) +
                      cuts + observe("work of the cut, kinetic energy, energy of loads, crumbs"));
    EXPECT_GT(block.last("crumbs"), 0);
    const auto work = block.series("work of the cut"), kinetic = block.series("kinetic energy");
    const double most = *std::ranges::max_element(kinetic);
    for (std::size_t k = 1; k < work.size(); ++k)
      EXPECT_LT(work[k] - work[k - 1], 0.02 * most) << k;
  };
  const std::string pressure = section("Pressure p", {"Faces = revealed", "Pressure [Pa] = 1115*min(t*5,1)"});
  for (const std::string integrator : {"BDF2", "implicit Euler", "generalised alpha"}) {
    SCOPED_TRACE(integrator);
    for (const std::string backend : {"fem", "mass-spring"})
      check({"Sides [m] = 0.4, 0.2, 0.2", "Backend = " + backend, "Integrator = " + integrator}, pressure,
            section("Blade k", {"Edge [m] = 0, -0.6, 0; 0, 0.6, 0", "Times [s] = 0, 0.28",
                                "Positions [m] = 0.33, 0, -0.0826; -0.33, 0, -0.0826"}));
  }
}

/// What holds a skin that is set in motion at once rings, where nothing damps that, until a cut: no work is booked of
/// forces that the step after it does not take.
TEST(EnergyScene, BooksCloseAtACutWhereALoadRings) {
  const Trial block(
    steps(0.01, 30) +
    section("Body b", {"Shape = box", "Sides [m] = 0.4, 0.4, 0.3", "Cube edge [m] = 0.1", "Integrator = Newmark"},
            material(1.7e5, 0.015) +
              section("Support w", box("-1.2, -9, -9", "-0.19, 9, 9") +
                                     Keys{"Hold at = skin", "Displacement [m] = -0.0248*t; -0.0646*t; -0.0246*t",
                                          "Rotation [degrees] = 16.5*t; -25.9*t; 6.66*t", "Pivot [m] = -0.2, 0, 0"})) +
    section("Blade k", {"Edge [m] = 0, 0, -0.65; 0, 0, 0.65", "Times [s] = 0, 0.28",
                        "Positions [m] = 0.0947, 0.33, 0; 0.0947, -0.33, 0"}) +
    observe("kinetic energy, missing energy, cut edges"));
  EXPECT_GT(block.last("cut edges"), 0);
  const auto missing = block.series("missing energy"), kinetic = block.series("kinetic energy");
  const double most = *std::ranges::max_element(kinetic);
  for (std::size_t k = 1; k < missing.size(); ++k)
    EXPECT_LT(std::abs(missing[k] - missing[k - 1]), 0.1 * most) << k;
}

/// A load that grows with time works through its potential's own change too: nothing is missing.
TEST(EnergyScene, BooksOfALoadThatGrowsClose) {
  for (const std::string integrator : {"quasi-static", "Newmark"}) {
    SCOPED_TRACE(integrator);
    const Trial bar(steps(0.02, 40) +
                    section("Body bar", bar_keys() + Keys{"Integrator = " + integrator},
                            material(1e5, 0.3) + sliding_end() +
                              section("Traction end", box("0.99, -1, -1", "2, 1, 1") +
                                                        Keys{"Traction [N/m^2] = 500*(1 - cos(4*t)); 0; 0"})) +
                    observe("elastic energy, work of loads, missing energy"));
    EXPECT_GT(bar.last("elastic energy"), 0.01);
    EXPECT_GT(std::abs(bar.last("work of loads")), 0.01);
    EXPECT_LT(std::abs(bar.last("missing energy")), 2e-3 * bar.last("elastic energy"));
  }
}

/// Where the skin lies in a layer of nodes, cells outside of it have corners without mass: they take no acceleration.
TEST(EnergyScene, CornersWithoutMassDoNotFlyAway) {
  const Trial bar(steps(0.01, 10) + section("Gravity", {}) +
                  section("Body bar",
                          Keys{"Mesh = " + mesh_path("bar.off"), "Cube edge [m] = 0.1", "Lattice offset [1] = 0, 0, 0",
                               "Integrator = generalised alpha"},
                          material(1e5, 0.3) + section("Support wall", box("-1, -1, -1", "0.001, 1, 1"))) +
                  observe("largest displacement, missing energy"));
  EXPECT_GT(bar.last("largest displacement"), 0.01);
  EXPECT_LT(bar.last("largest displacement"), 0.1);
}

} // namespace
} // namespace kerf::scene::energy_scenes_test
