// Every backend in the same scenes: cut apart and falling, landing on a floor, hanging from forceps.

#include "tests/scene/trials.h"

#include <Eigen/Geometry>

#include <map>

namespace kerf::scene::backend_scenes_test {
namespace {

constexpr double g = 9.81; // [m/s^2]
const std::vector<std::string> backends = {"fem", "pba", "lattice", "mass-spring"};

/// A cube of a backend; small enough steps for all.
std::string cube_of(const std::string& backend, const std::string& inside, const Keys& more = {}) {
  std::string physics = material(1e5, 0.25) + inside;
  if (backend == "pba")
    physics += section("Phyxels", {"Spacing [m] = 0.04"});
  if (backend == "lattice")
    physics += section("Lattice", {"Half width [cells] = 1", "Alpha [1] = 1"});
  return section("Body cube", cube_keys() + Keys{"Backend = " + backend} + more, physics);
}

/// Cut by the plane x = 0.01 at once: one half is held, the other falls as a whole, by the rule of its integrator.
TEST(BackendScene, WhatIsCutOffFallsFreely) {
  const double dt = 0.002;
  const int n = 20;
  for (const std::string& backend : backends) {
    SCOPED_TRACE(backend);
    const Trial cube(steps(dt, n) + section("Gravity", {}) +
                     cube_of(backend, section("Support hand", box("-1, -1, -1", "-0.03, 1, 1"))) +
                     section("Cut surface knife", {"Shape = plane", "Point [m] = 0.01, 0, 0", "Normal [1] = 1, 0, 0"}) +
                     observe("pieces, momentum z, mass, reactions"));
    EXPECT_EQ(cube.last("pieces"), 2);
    const Body& body = cube.body();
    const auto pieces = grid::corner_pieces(body.solid.complex);
    const Points& x = corners(body);
    const Points rest = grid::rest_positions(body.solid);
    std::map<std::uint32_t, std::pair<double, double>> fall; // of each piece: least and most
    for (std::size_t c = 0; c < x.size(); ++c) {
      const double way = rest[c][2] - x[c][2];
      auto& [least, most] = fall.try_emplace(pieces[c], way, way).first->second;
      least = std::min(least, way);
      most = std::max(most, way);
    }
    const std::uint32_t held = fall[0].first < fall[1].first ? 0 : 1;
    const double expected = 0.5 * g * dt * dt * n * (n + 1); // both Euler methods
    EXPECT_NEAR(fall[1 - held].first, expected, 1e-5 * expected);
    EXPECT_NEAR(fall[1 - held].second, expected, 1e-5 * expected);
    EXPECT_LT(fall[held].second, 0.5 * expected);
    EXPECT_LT(fall[held].first, 1e-12) << "where it is held";
  }
}

/// A blade on its way through a cube that hangs parts it too.
TEST(BackendScene, ABladePartsAHangingCube) {
  for (const std::string& backend : backends) {
    SCOPED_TRACE(backend);
    const Trial cube(steps(0.005, 40) + section("Gravity", {}) +
                     cube_of(backend, section("Support hand", box("-1, -1, -1", "-0.03, 1, 1"))) +
                     section("Blade knife", {"Edge [m] = 0, -0.2, 0; 0, 0.2, 0", "Times [s] = 0, 0.1",
                                             "Positions [m] = 0.01, 0, 0.13; 0.01, 0, -0.16"}) +
                     observe("pieces, waiting cuts"));
    EXPECT_EQ(cube.last("pieces"), 2);
    EXPECT_GT(value(cube.body(), "largest displacement"), 0.02) << "one half falls";
  }
}

/// A budget of looks a step leaves pairs waiting after a cut, and takes so many off the list each step.
TEST(BackendScene, PhyxelsLookUnderABudget) {
  const Trial cube(steps(0.002, 20) +
                   cube_of("pba", section("Visibility", {"Criterion = extended visibility", "Budget [1] = 40"})) +
                   section("Cut surface knife",
                           {"Shape = disc", "Point [m] = 0.01, 0, 0.1", "Normal [1] = 1, 0, 0", "Radius [m] = 0.1"}) +
                   observe("waiting pairs, pieces"));
  const auto waiting = cube.series("waiting pairs");
  EXPECT_EQ(waiting[0], 0);
  ASSERT_GT(waiting[1], 120);
  for (std::size_t i = 2; i < waiting.size(); ++i)
    EXPECT_EQ(waiting[i], std::max(0.0, waiting[i - 1] - 40)) << "step " << i;
}

/// Sum of k A d over the vertices of a surface below a height, each with a third of its triangles' rest areas.
double penalty(const Body& body, const double height, const double k) {
  double sum = 0;
  for (const Triangle& t : body.surface.triangles) {
    const auto X = [&](const int i) { return body.surface.rest[t[i]]; };
    const double area = 0.5 * (X(1) - X(0)).cross(X(2) - X(0)).norm();
    for (const auto vertex : t)
      sum += k * area / 3 * std::max(0.0, height - positions(body)[vertex][2]);
  }
  return sum;
}

/// A floor under a falling cube takes its weight; the cube sinks in by weight / (k A).
TEST(BackendScene, ACubeLandsAndRests) {
  const double k = 2e5;
  for (const std::string& backend : backends) {
    SCOPED_TRACE(backend);
    const int n = backend == "lattice" ? 480 : 240; // its steps damp less by themselves
    const Trial cube(
      steps(0.005, n) + section("Gravity", {}) +
      section("Floor ground", {"Point [m] = 0, 0, -0.11", key("Stiffness [N/m^3]", k), "Friction [1] = 0"}) +
      cube_of(backend,
              section("Damping", {"Mass damping [1/s] = 6"}) + section("Probe middle", {"Point [m] = 0, 0, -0.095"})) +
      observe("load forces, probes, kinetic energy, mass"));
    const double weight = cube_mass * g;
    const auto force = cube.series("force of ground z");
    double mean = 0; // of the last 0.4 s
    for (int i = n - 79; i <= n; ++i)
      mean += force[i] / 80;
    EXPECT_NEAR(cube.last("mass"), cube_mass, 1e-9);
    EXPECT_NEAR(mean, weight, 0.005 * weight);
    EXPECT_EQ(cube.last("force of ground x"), 0);
    EXPECT_LT(cube.last("kinetic energy"), 1e-4);
    const double sunk = weight / (k * cube_face);
    const double way = -0.01 - cube.last("probe middle z"); // coarse: the rim of the sides counts too
    EXPECT_GT(way, 0.7 * sunk);
    EXPECT_LT(way, 1.05 * sunk);
    // Forces on phyxels are those of points that follow them without their gradients.
    EXPECT_NEAR(force.back(), penalty(cube.body(), -0.11, k), (backend == "pba" ? 0.1 : 1e-9) * weight);
    EXPECT_EQ(force[2], 0) << "in the air";
    EXPECT_GT(*std::max_element(force.begin(), force.end()), 1.5 * weight) << "landing";
  }
}

/// Gravity with a slope of 0.3 along x, and mass damping a against bouncing. With mu = 0.5 the cube creeps at the
/// velocity s where friction holds it: mu (s/e)(2 - s/e) gz = gx - a s. With mu = 0.2 it slides:
/// v = (gx - mu gz) (1 - exp(-a t)) / a. A lattice takes the floor explicitly and trembles on it, so that it creeps by
/// 15 % faster.
TEST(BackendScene, FrictionHoldsBelowItsAngleAndNotAbove) {
  const double slope = 0.3, creep = 0.1, a = 4, gx = g * slope / std::hypot(1, slope), gz = g / std::hypot(1, slope);
  const auto expected_velocity = [&](const double mu) {
    if (mu < slope)
      return (gx - mu * gz) * (1 - std::exp(-a * 1.5)) / a;
    double s = 0;
    for (int i = 0; i < 20; ++i)
      s = creep * (1 - std::sqrt(1 - (gx - a * s) / (mu * gz)));
    return s;
  };
  for (const std::string& backend : backends) {
    SCOPED_TRACE(backend);
    const std::string newton = backend == "lattice" ? "" : section("Implicit Euler", {"Newton iterations [1] = 4"});
    for (const double mu : {0.5, 0.2}) {
      const Trial cube(
        steps(0.008, 200) + section("Gravity", {"Acceleration [m/s^2] = " + to_text(gx) + ", 0, " + to_text(-gz)}) +
        section("Floor slope", {"Point [m] = 0, 0, -0.1", "Stiffness [N/m^3] = 2e5", key("Friction [1]", mu),
                                key("Creep velocity [m/s]", creep)}) +
        cube_of(backend, section("Damping", {key("Mass damping [1/s]", a)}) + newton) + observe("momentum x"));
      const auto p = cube.series("momentum x");
      double last = 0; // mean of the last 0.2 s
      for (int i = 176; i <= 200; ++i)
        last += p[i] / cube_mass / 25;
      const double expected = expected_velocity(mu);
      std::printf("%-12s mu %.1f: %.4f m/s, %.4f of the closed form\n", backend.c_str(), mu, last, last / expected);
      EXPECT_NEAR(last, expected, (backend == "lattice" ? 0.2 : 0.1) * expected);
    }
  }
}

/// Gripped above, free below: the forceps carry the weight.
TEST(BackendScene, ForcepsCarryWhatHangs) {
  const std::string forceps = section(
    "Forceps tweezers",
    {"Region = box", "Lower [m] = -1, -1, 0.03", "Upper [m] = 1, 1, 1", "Times [s] = 0", "Positions [m] = 0, 0, 0"});
  const double weight = cube_mass * g;
  for (const std::string& backend : backends) {
    SCOPED_TRACE(backend);
    const bool is_static = backend != "lattice";
    const Trial cube((is_static ? steps(1, 1) : steps(0.005, 600)) + section("Gravity", {}) +
                     cube_of(backend, is_static ? "" : section("Damping", {"Mass damping [1/s] = 6"}),
                             is_static ? statics() : Keys{}) +
                     forceps + observe("tool forces, kinetic energy"));
    EXPECT_NEAR(cube.last("tool force tweezers z"), weight, (is_static ? 1e-4 : 2e-3) * weight);
    EXPECT_NEAR(cube.last("tool force tweezers x"), 0, 2e-3 * weight);
  }
}

/// What forceps have let go falls freely from the next step on: integrators that remember accelerations do not take the
/// force of the grip along (Newmark's next step once fell by a third of g dt).
TEST(BackendScene, WhatForcepsLetGoFallsAtOnce) {
  constexpr double dt = 0.01;
  for (const std::string integrator : {"implicit Euler", "Newmark", "generalised alpha", "velocity Verlet"}) {
    SCOPED_TRACE(integrator);
    const double step = integrator == "velocity Verlet" ? dt / 20 : dt;
    const int n_held = static_cast<int>(std::lround(1 / step));
    const Trial cube(steps(step, n_held + 1) + section("Gravity", {}) +
                     cube_of("fem", section("Damping", {"Mass damping [1/s] = 10"}), {"Integrator = " + integrator}) +
                     section("Forceps tweezers",
                             {"Region = box", "Lower [m] = -1, -1, 0.03", "Upper [m] = 1, 1, 1", "Times [s] = 0",
                              "Positions [m] = 0, 0, 0", key("Release time [s]", n_held * step)}) +
                     observe("momentum z"));
    const double v = cube.last("momentum z") / cube_mass, free_fall = -g * step;
    EXPECT_NEAR(v, free_fall, 0.1 * std::abs(free_fall)); // 10 / s take some of it
  }
}

/// Corners that follow phyxels jump when a cut takes phyxels out of their sight: none may jump past the blade uncut.
/// The blade's plane is a layer of nodes, where it has most edges along it.
TEST(BackendScene, ABladePartsABarOfPhyxelsBetweenItsHeldEnds) {
  const Trial bar(
    steps(0.002, 400) + section("Gravity", {}) +
    section("Body bar", Keys{"Mesh = " + mesh_path("bar.off"), "Cube edge [m] = 0.04", "Backend = pba"},
            material(3e5, 0.3) + section("Damping", {"Mass damping [1/s] = 3"}) +
              section("Support left", {"Region = sphere", "Centre [m] = 0, 0.1, 0.1", "Radius [m] = 0.15"}) +
              section("Support right", box("0.9, -1, -1", "2, 1, 1"))) +
    section("Blade knife", {"Edge [m] = 0, -0.2, 0; 0, 0.5, 0", "Times [s] = 0.2, 0.8",
                            "Positions [m] = 0.5, 0, 0.25; 0.5, 0, -0.3"}) +
    observe("pieces"));
  // It may leave splinters of the skin along those edges; all nodes are in two pieces.
  const grid::CellComplex& complex = bar.body().solid.complex;
  const grid::Pieces pieces = grid::pieces(complex);
  std::map<std::uint32_t, int> n_copies;
  for (const auto c : ids<grid::CopyId>(complex.n_copies()))
    n_copies[pieces.piece[c]] += complex.copies[c].nodes != 0;
  std::erase_if(n_copies, [](const auto& piece) { return piece.second == 0; });
  EXPECT_EQ(n_copies.size(), 2u);
}

} // namespace
} // namespace kerf::scene::backend_scenes_test
