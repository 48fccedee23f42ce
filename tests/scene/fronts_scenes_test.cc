/// Blades that stop inside a cell, by explicit steps: the bar then hangs as a bar at rest with the same cut.

#include "tests/scene/trials.h"

#include <cmath>
#include <cstdio>
#include <utility>

namespace kerf::scene::fronts_scenes_test {
namespace {

/// A clamped bar of 4 cells across that sags a little, cut near the clamp from above down to a height [m]: how far its
/// end comes down [m].
double sag(const std::string& backend, const std::string& integrator, const double dt, const double end) {
  const bool is_static = integrator == "quasi-static";
  const std::string inside = material(2e6, 0.25) +
                             section("Support wall", box("-1, -1, -1", "0.04, 1, 1")) +
                             (is_static ? "" : section("Damping", {"Mass damping [1/s] = 12"}));
  const Trial bar(
    steps(dt, static_cast<int>(std::lround(1.2 / dt))) +
    section("Gravity", {"Acceleration [m/s^2] = 0, 0, -1"}) +
    section("Body bar",
            Keys{"Mesh = " + mesh_path("bar.off"), "Cube edge [m] = 0.05", "Backend = " + backend,
                 "Integrator = " + integrator},
            inside) +
    section("Blade knife", {"Edge [m] = 0, -0.1, 0; 0, 0.3, 0", "Times [s] = 0, 0.4",
                            "Positions [m] = 0.26, 0, 0.25; 0.26, 0, " + to_text(end)}) +
    observe("largest displacement"));
  return bar.last("largest displacement");
}

/// To within what a front is ahead of where it is for explicit steps, in the cell that the front, with its lag, enters at
/// .125 m and passes at .075 m.
void expect_alike(const std::string& backend, const std::string& at_rest, const double dt_at_rest, const double dt,
                  const double lag) {
  double before = 0;
  for (const auto& [front, tolerance] : {std::pair{0.1065, 0.05}, {0.0855, 0.005}}) {
    const double end = front + lag * 0.05;
    const double explicitly = sag(backend, "velocity Verlet", dt, end),
                 reference = sag(backend, at_rest, dt_at_rest, end);
    std::printf("%s, blade down to %.3f m: %.5f m, at rest %.5f m\n", backend.c_str(), end, explicitly, reference);
    EXPECT_NEAR(explicitly, reference, tolerance * reference) << backend << ' ' << end;
    EXPECT_GT(explicitly, (before > 0 ? 1.005 : 1.0) * before) << backend << ' ' << end;
    before = explicitly;
  }
}

TEST(FrontsOfExplicitSteps, AreWhereTheBladeStoppedInElements) { expect_alike("fem", "quasi-static", 0.05, 4e-4, 0.25); }
TEST(FrontsOfExplicitSteps, AreWhereTheBladeStoppedInSprings) {
  expect_alike("mass-spring", "implicit Euler", 0.01, 4e-4, 0.5);
}

/// A bar that sags and swings is cut halfway through by a blade that stops and withdraws. Where it did not go where a
/// front was ahead of it, what skin lies between goes with the side on which the blade has left it, though the wound
/// gapes: each line of the skin in a face of the grid is cut once, and no flap is left between two cuts.
TEST(FrontsOfMovingBodies, LeaveNoFlapOfSkin) {
  for (const std::string depth : {"0.08", "0.1", "0.05"}) {
    World world = compose(read_scene_text(support::checkout() + "/params/first.prm",
                                          {"Blade knife/Positions [m]=0.25, 0, 0.25; 0.25, 0, " + depth +
                                             "; 0.25, 0, 0.35",
                                           "Time/End time [s]=1.2", "Images/Every [1]=1000"}));
    Timings seconds;
    for (int step = 1; step <= world.n_steps; ++step)
      advance(world, step, seconds);
    const grid::Solid& solid = world.bodies[0].solid;
    int n_cut = 0;
    for (const auto face : ids<grid::FaceId>(solid.grid.n_faces())) {
      int n = 0;
      for (int place = 0; place < 4; ++place)
        n += solid.cuts.is_cut(grid::SkinSegment::half(face, place));
      EXPECT_LE(n, 1) << depth;
      n_cut += n;
    }
    EXPECT_GT(n_cut, 10) << depth;
    EXPECT_EQ(value(world.bodies[0], "pieces"), 1) << depth;
  }
}

} // namespace
} // namespace kerf::scene::fronts_scenes_test
