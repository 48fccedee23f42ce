// Scenes of statics with known answers: loads, supports, probes.

#include "base/error.h"
#include "tests/scene/trials.h"

#include <numbers>

namespace kerf::scene::statics_scenes_test {
namespace {

constexpr double E = 1e5; // [Pa]

/// A bar with what stands in its body, one static step, and observables.
std::string static_bar(const std::string& inside, const std::string& names, const Keys& more = {}, const int n = 3) {
  return steps(1, 1) + section("Body bar", bar_keys(n) + statics() + more, inside) + observe(names);
}

std::string pulled_end() {
  return section("Traction pull", box("0.99, -1, -1", "1.1, 1, 1") + Keys{"Traction [N/m^2] = 100; 0; 0"});
}

std::string probe(const std::string& name, const std::string& point) {
  return section("Probe " + name, {"Point [m] = " + point});
}

/// sigma = 100 Pa: u = (s x, -nu s (y - 0.1), -nu s (z - 0.1)), s = sigma / E.
TEST(StaticScene, BarUnderTractionIsInUniaxialStress) {
  const double strain = 100 / E, nu = 0.3, h = 0.2 / 3;
  for (const std::string law : {"small strain", "corotational", "St. Venant-Kirchhoff", "neo-Hookean"})
    for (const std::string element : {"trilinear", "enhanced"}) {
      SCOPED_TRACE(law + ", " + element);
      const Trial bar(
        static_bar(material(E, nu, law) + sliding_end() + pulled_end() + probe("end", "0.999, 0.1, 0.1") +
                     probe("side", "0.5, 0.19, 0.1") + probe("top", "0.4, 0.1, 0.02"),
                   "reactions, load forces, probes, probe strains, energy of loads, elastic energy, volume",
                   {"Element = " + element}));
      const double size = law == "small strain" ? 1e-3 : 2e-3; // strains of 1e-3 show nonlinear laws
      EXPECT_NEAR(bar.last("force of pull x"), 100 * bar_area, 1e-12);
      EXPECT_NEAR(bar.last("reaction wall x"), -100 * bar_area, 1e-6);
      for (const std::string other : {"reaction wall y", "reaction y y", "reaction z z", "reaction y x"})
        EXPECT_NEAR(bar.last(other), 0, 1e-6) << other;
      EXPECT_NEAR(bar.last("probe end x"), strain * (0.999 - 0.001 * h), size * strain);
      EXPECT_NEAR(bar.last("probe end y"), 0, 1e-9);
      EXPECT_NEAR(bar.last("probe side x"), strain * (0.5 - 0.001 * h), size * strain);
      if (law == "small strain") { // away from held corners, tractions on a skin between nodes are exact
        EXPECT_NEAR(bar.last("probe end x") - bar.last("probe side x"), strain * 0.499, 1e-7 * strain);
      }
      EXPECT_NEAR(bar.last("probe side y"), -nu * strain * 0.09, size * strain);
      EXPECT_NEAR(bar.last("probe top z"), nu * strain * 0.08, size * strain);
      EXPECT_NEAR(bar.last("strain side xx"), strain + strain * strain / 2, size * strain);
      EXPECT_NEAR(bar.last("strain side yy"), -nu * strain, size * strain);
      EXPECT_NEAR(bar.last("strain top zz"), -nu * strain, size * strain);
      EXPECT_NEAR(bar.last("strain side xy"), 0, size * strain);
      const double work = 100 * bar_area * strain * (1 - 0.001 * h);
      EXPECT_NEAR(bar.last("energy of loads"), -work, size * work);
      EXPECT_NEAR(bar.last("elastic energy"), work / 2, size * work);
    }
}

/// Springs are an isotropic solid of nu = 1/4 in uniform strain; phyxels have rough ends.
TEST(StaticScene, BarUnderTractionIsAsLongWithPointsAndSprings) {
  const double strain = 100 / E;
  const std::string loads = section("Support wall", box("-1, -1, -1", "0.04, 1, 1") + Keys{"Hold = x"}) +
                            section("Support y", box("-1, 0.06, -1", "1, 0.14, 1") + Keys{"Hold = y"}) +
                            section("Support z", box("-1, -1, 0.06", "1, 1, 0.14") + Keys{"Hold = z"}) + pulled_end() +
                            probe("near", "0.3, 0.1, 0.1") + probe("far", "0.7, 0.1, 0.1");
  for (const auto& [backend, tolerance] : {std::pair("mass-spring", 0.01), std::pair("pba", 0.02)}) {
    SCOPED_TRACE(backend);
    const std::string inside = material(E, 0.25) + loads +
                               (std::string(backend) == "pba" ? section("Phyxels", {"Spacing [m] = 0.0333333"}) : "");
    const Trial bar(static_bar(inside, "reactions, probes", {"Backend = " + std::string(backend)}));
    EXPECT_NEAR(bar.last("reaction wall x"), -100 * bar_area, 1e-5);
    EXPECT_NEAR(bar.last("probe far x") - bar.last("probe near x"), 0.4 * strain, tolerance * 0.4 * strain);
    std::printf("%s: extension %.4f of the closed form\n", backend,
                (bar.last("probe far x") - bar.last("probe near x")) / (0.4 * strain));
  }
}

/// u = -p (1 - 2 nu) / E X, held in its middle planes.
TEST(StaticScene, PressureAllAroundMakesACubeSmaller) {
  const double p = 50, nu = 0.3;
  const Keys keys = {"Mesh = " + mesh_path("cube.off"), key("Cube edge [m]", 0.2 / 9)};
  std::string inside = material(E, nu, "small strain") + section("Pressure sea", {"Pressure [Pa] = 50"}) +
                       probe("off", "0.07, 0.06, -0.07");
  for (const auto& [axis, lower, upper] :
       {std::tuple("x", "-0.001, -1, -1", "0.001, 1, 1"), std::tuple("y", "-1, -0.001, -1", "1, 0.001, 1"),
        std::tuple("z", "-1, -1, -0.001", "1, 1, 0.001")})
    inside += section("Support " + std::string(axis), box(lower, upper) + Keys{"Hold = " + std::string(axis)});
  const Trial cube(steps(1, 1) + section("Body cube", keys + statics(), inside) +
                   observe("probes, load forces, volume, rest volume, reactions"));
  const double strain = -p * (1 - 2 * nu) / E;
  EXPECT_NEAR(cube.last("probe off x"), 0.07 * strain, 2e-3 * 0.07 * -strain);
  EXPECT_NEAR(cube.last("probe off y"), 0.06 * strain, 2e-3 * 0.07 * -strain);
  EXPECT_NEAR(cube.last("probe off z"), -0.07 * strain, 2e-3 * 0.07 * -strain);
  EXPECT_NEAR(cube.last("volume") / cube.last("rest volume") - 1, 3 * strain, 1e-3 * -3 * strain);
  for (const std::string axis : {"x", "y", "z"}) {
    EXPECT_NEAR(cube.last("force of sea " + axis), 0, 1e-12) << "a closed surface";
    EXPECT_NEAR(cube.last("reaction " + axis + " " + axis), 0, 1e-6);
  }
}

/// Near nu = 1/2 a little shear is much beside what compression takes: a box whose skin lies askew to the grid has the
/// energy p^2 V / 2 K and no shear at all.
TEST(StaticScene, PressureAllAroundATurnedBoxOnlyCompressesIt) {
  constexpr double p = 50, nu = 0.499, bulk = E / (3 * (1 - 2 * nu));
  for (const std::string element : {"trilinear", "enhanced"}) {
    SCOPED_TRACE(element);
    const Keys keys = {"Shape = box",
                       "Centre [m] = 0.1, 0.05, 0.05",
                       "Sides [m] = 0.2, 0.1, 0.1",
                       "Rotation [degrees] = 20, 35, 10",
                       "Cube edge [m] = 0.0213",
                       "Element = " + element};
    const std::string inside = material(E, nu, "small strain") + section("Pressure sea", {"Pressure [Pa] = 50"}) +
                               section("Handle middle", {"Point [m] = 0.1, 0.05, 0.05"}) +
                               section("Handle end", {"Point [m] = 0.15, 0.06, 0.05"}) +
                               section("Handle side", {"Point [m] = 0.1, 0.06, 0.06"});
    const Trial box(steps(1, 1) + section("Body box", keys + statics(), inside) +
                    observe("elastic energy, rest volume"));
    EXPECT_NEAR(box.last("elastic energy") / (p * p * box.last("rest volume") / (2 * bulk)), 1, 1e-4);
  }
}

TEST(StaticScene, PressureOnAnEndPushesAgainstIt) {
  const Trial bar(
    static_bar(material(E, 0.3) + clamped_end() +
                 section("Pressure push", box("0.99, -1, -1", "1.1, 1, 1") + Keys{"Pressure [Pa] = 10*t"}),
               "reactions, load forces"));
  const double force = 10 * bar_area * (1 + 2 * 0.3 * 10 / E); // the end widens
  EXPECT_NEAR(bar.last("force of push x"), -force, 1e-6 * force);
  EXPECT_NEAR(bar.last("reaction wall x"), force, 1e-6 * force);
}

/// Cut across between two walls, and blown apart: before the cut the pressure acts on nothing, after it each half
/// pushes its wall. On all faces it acts on the sides too, which cancel.
TEST(StaticScene, PressureOnRevealedFacesOpensACut) {
  for (const std::string faces : {"revealed", "all"}) {
    SCOPED_TRACE(faces);
    const std::string inside = material(E, 0, "small strain") + clamped_end() +
                               section("Support end", box("0.93, -1, -1", "2, 1, 1")) +
                               section("Pressure gas", {"Faces = " + faces, "Pressure [Pa] = 20"});
    const Trial bar(steps(1, 2) + section("Body bar", bar_keys() + statics(), inside) +
                    section("Cut surface knife",
                            {"Time [s] = 1", "Shape = plane", "Point [m] = 0.52, 0, 0", "Normal [1] = 1, 0, 0"}) +
                    observe("reactions, load forces, pieces, largest displacement"));
    EXPECT_EQ(bar.last("pieces"), 2);
    const auto wall = bar.series("reaction wall x"), end = bar.series("reaction end x");
    const double force = 20 * bar_area;
    EXPECT_NEAR(wall[1], faces == "all" ? -force : 0, 1e-3 * force) << "on the end itself";
    const double opened = wall[2] - wall[1];
    EXPECT_NEAR(opened, force, 1e-3 * force);
    EXPECT_NEAR(end[2] - end[1], -force, 1e-3 * force);
    EXPECT_NEAR(bar.last("force of gas x"), 0, 1e-4) << "both sides of the cut";
  }
}

/// f = 1000 x N/m^3 along x, nu = 0: N(x) = 500 A (1 - x^2), u(1) = 500 (1 - 1/3) / E.
TEST(StaticScene, BodyForceAddsUpAlongABar) {
  const Trial bar(static_bar(material(E, 0, "small strain") + clamped_end() +
                               section("Body force field", {"Force density [N/m^3] = 1000*x; 0; 0"}) +
                               probe("end", "0.999, 0.1, 0.1"),
                             "reactions, load forces, probes"));
  EXPECT_NEAR(bar.last("force of field x"), 500 * bar_area, 1e-9);
  EXPECT_NEAR(bar.last("reaction wall x"), -500 * bar_area, 1e-5);
  EXPECT_NEAR(bar.last("probe end x"), 500 * (2. / 3) / E, 0.005 * 500 * (2. / 3) / E);
}

/// Spring and body in series: F = k (D - u), and the body's u / F is its own, whatever the spring.
TEST(StaticScene, HandleIsASpringInSeries) {
  const auto pulled = [&](const double k) {
    return Trial(static_bar(material(E, 0.3, "small strain") + clamped_end() + probe("grip", "0.9, 0.1, 0.1") +
                              section("Handle hand", {"Point [m] = 0.9, 0.1, 0.1", key("Stiffness [N/m]", k),
                                                      "Displacement [m] = 0.01*t; 0; 0"}),
                            "reactions, load forces, probes, energy of loads"));
  };
  double compliance = 0;
  for (const double k : {100., 1e4}) {
    const Trial bar = pulled(k);
    const double force = bar.last("force of hand x"), u = bar.last("probe grip x");
    EXPECT_NEAR(force, k * (0.01 - u), 1e-9);
    EXPECT_NEAR(bar.last("reaction wall x"), -force, 1e-4 * force);
    EXPECT_NEAR(bar.last("energy of loads"), 0.5 * force * force / k, 1e-9);
    EXPECT_GT(u, force * 0.9 / (E * bar_area)) << "a point gives way more than a face";
    if (compliance > 0) {
      EXPECT_NEAR(u / force, compliance, 1e-6 * compliance);
    }
    compliance = u / force;
  }
}

/// Displacements and pressures together, with multigrid for what is left (fem/dilatation.h): iterations hardly grow,
/// where conjugate gradients take as many more as the root of lambda over mu says (results/README.md).
TEST(StaticScene, NearlyIncompressibleBarsKeepToMultigrid) {
  std::vector<double> counts;
  for (const double nu : {0.3, 0.499, 0.4999}) {
    const Trial bar(static_bar(material(1e7, nu, "small strain") + clamped_end() + probe("end", "0.999, 0.1, 0.1"),
                               "solver iterations, probes", {"Element = enhanced"}, 6) +
                    section("Gravity", {}));
    counts.push_back(bar.last("solver iterations"));
    EXPECT_NEAR(bar.last("probe end z") / -0.0364, 1, 0.05) << nu << ": of the same length at any nu";
  }
  EXPECT_LT(counts[0], 30);
  EXPECT_LT(counts[1], 80) << counts[0];
  EXPECT_LT(counts[2], 120) << counts[1];
}

/// An end turned by a small angle: uniform twist, torque G J angle / L with J = 0.1406 a^4 and some more as the ends
/// stay plane. The energy is half of what the supports have done.
TEST(StaticScene, TurnedSupportTwistsABar) {
  const double nu = 0.3, angle = std::numbers::pi / 180, G = E / (2 * (1 + nu)), J = 0.1406 * std::pow(0.2, 4);
  const std::string turned = section(
    "Support hand", box("0.93, -1, -1", "2, 1, 1") + Keys{"Rotation [degrees] = t; 0; 0", "Pivot [m] = 0, 0.1, 0.1"});
  const Trial bar(static_bar(material(E, nu) + clamped_end() + turned + probe("middle", "0.5, 0.19, 0.1"),
                             "reactions, probes, elastic energy, work of supports, missing energy",
                             {"Element = enhanced"}, 5));
  const double first = 0.001 * 0.04, last = first + 24 * 0.04; // layers of nodes that are held
  EXPECT_NEAR(bar.last("probe middle z"), angle * 0.09 * (0.5 - first) / (last - first), 2e-3 * angle * 0.09);
  EXPECT_NEAR(bar.last("probe middle x"), 0, 1e-3 * angle * 0.09);
  const double energy = 0.5 * G * J * angle * angle / (last - first);
  EXPECT_NEAR(bar.last("elastic energy"), energy, 0.06 * energy);
  EXPECT_NEAR(bar.last("work of supports"), bar.last("elastic energy"), 1e-3 * energy);
  EXPECT_NEAR(bar.last("missing energy"), 0, 1e-3 * energy);
  for (const std::string axis : {"x", "y", "z"}) // to what the balance leaves of forces of 1.5 N
    EXPECT_NEAR(bar.last("reaction hand " + axis), -bar.last("reaction wall " + axis), 4e-6);
}

/// Both ends turned alike and moved: a rigid motion, whatever the angle.
TEST(StaticScene, SupportsThatTurnAlikeStrainNothing) {
  const Keys turned = {"Rotation [degrees] = 0; 0; 30*t", "Pivot [m] = 0.2, 0, 0", "Displacement [m] = 0; 0.1*t; 0"};
  const Trial bar(static_bar(material(E, 0.3) + section("Support wall", box("-1, -1, -1", "0.01, 1, 1") + turned) +
                               section("Support hand", box("0.93, -1, -1", "2, 1, 1") + turned) +
                               probe("middle", "0.5, 0.1, 0.1"),
                             "probes, elastic energy, probe strains"));
  const double a = std::numbers::pi / 6;
  EXPECT_NEAR(bar.last("probe middle x"), 0.2 + 0.3 * std::cos(a) - 0.1 * std::sin(a) - 0.5, 1e-6);
  EXPECT_NEAR(bar.last("probe middle y"), 0.3 * std::sin(a) + 0.1 * std::cos(a) + 0.1 - 0.1, 1e-6);
  EXPECT_NEAR(bar.last("strain middle xx"), 0, 1e-6);
  EXPECT_LT(bar.last("elastic energy"), 1e-9);
}

/// Held along a slanted direction only: the reaction is along it, and so is what does not move.
TEST(StaticScene, HeldDirectionSlidesAcross) {
  const Trial bar(
    static_bar(material(E, 0.3) + clamped_end() + probe("end", "0.98, 0.1, 0.1") +
                 section("Support rail", box("0.93, -1, -1", "2, 1, 1") + Keys{"Held direction [1] = 0, 3, 4",
                                                                               "Displacement [m] = 0; "
                                                                               "0.003; 0.004"}),
               "reactions, probes"));
  const double y = bar.last("reaction rail y"), z = bar.last("reaction rail z");
  EXPECT_GT(y, 1e-3);
  EXPECT_NEAR(z / y, 4. / 3, 1e-6);
  EXPECT_NEAR(bar.last("reaction rail x"), 0, 1e-9);
  EXPECT_NEAR(0.6 * bar.last("probe end y") + 0.8 * bar.last("probe end z"), 0.005, 1e-6);
}

const std::vector<std::uint32_t>& held(const World& world) { return world.bodies[0].loads.supports.at(0).corners; }

TEST(StaticScene, RegionsHoldWhatLiesInThem) {
  const auto world_with = [&](const Keys& region) {
    return world_of(static_bar(material(E, 0.3) + section("Support wall", region), "reactions"));
  };
  const World boxed = world_with(box("-1, -1, -1", "0.01, 1, 1"));
  const World half = world_with({"Region = half space", "Plane point [m] = 0.01, 5, 7", "Plane normal [1] = 3, 0, 0"});
  EXPECT_GT(held(boxed).size(), 15u);
  EXPECT_EQ(held(half), held(boxed));

  const output::TemporaryFolder folder;
  std::ofstream(folder / "block.off")
    << "OFF\n8 12 0\n-1 -1 -1\n0.01 -1 -1\n-1 1 -1\n0.01 1 -1\n-1 -1 1\n0.01 -1 1\n"
       "-1 1 1\n0.01 1 1\n3 0 2 3\n3 0 3 1\n3 4 5 7\n3 4 7 6\n3 0 1 5\n3 0 5 4\n3 2 6 "
       "7\n3 2 7 3\n3 0 4 6\n3 0 6 2\n3 1 3 7\n3 1 7 5\n";
  const World meshed = world_with({"Region = mesh", "Region mesh = " + (folder / "block.off").string()});
  EXPECT_EQ(held(meshed), held(boxed));

  const World ball = world_with({"Region = sphere", "Centre [m] = 0.3, 0.1, 0.1", "Radius [m] = 0.12"});
  const Points& rest = ball.bodies[0].physics->rest();
  std::vector<std::uint32_t> inside;
  for (std::uint32_t i = 0; i < rest.size(); ++i)
    if ((rest[i] - Vec3(0.3, 0.1, 0.1)).norm() <= 0.12)
      inside.push_back(i);
  EXPECT_GT(inside.size(), 8u);
  EXPECT_EQ(held(ball), inside);
}

/// A ball held inside of a bar that hangs: its reaction is the weight.
TEST(StaticScene, ABallHoldsTheWholeWeight) {
  const Trial bar(static_bar(material(E, 0.3) + section("Support pin", {"Region = sphere", "Centre [m] = 0.5, 0.1, 0.1",
                                                                        "Radius [m] = 0.08"}),
                             "reactions") +
                  section("Gravity", {}));
  EXPECT_NEAR(bar.last("reaction pin z"), 40 * 9.81, 1e-3);
  EXPECT_NEAR(bar.last("reaction pin x"), 0, 1e-3);
}

/// A cylinder with a penny-shaped crack that nothing holds, pulled at both ends.
std::string free_cylinder(const std::string& law, const double up, const double down) {
  const auto pull = [](const std::string& name, const double z, const double traction) {
    return section("Traction " + name, box("-1, -1, " + to_text(z - 0.01), "1, 1, " + to_text(z + 0.01)) +
                                         Keys{"Traction [N/m^2] = 0; 0; " + to_text(traction)});
  };
  return steps(1, 2) +
         section("Body cylinder",
                 Keys{"Shape = cylinder", "Radius [m] = 0.5", "Height [m] = 1", "Cube edge [m] = 0.08"} + statics(),
                 material(E, 0.25, law) + section("Quasi-static", {"Free modes = allow"}) + pull("up", 0.5, up) +
                   pull("down", -0.5, -down)) +
         section("Cut surface crack",
                 {"Shape = disc", "Point [m] = 0, 0, 0", "Normal [1] = 0, 0, 1", "Radius [m] = 0.2"}) +
         observe("elastic energy, cut volumes, load forces, largest displacement");
}

/// Its ends' faces differ by some per cent in what the grid makes of their rims, so its loads are hardly in balance: it
/// is relieved of what would move it. Its energy is sigma^2 V / (2 E), and that of the crack (Sneddon 1946) beside it,
/// which stands up to one cube short.
TEST(StaticScene, ABodyThatOnlyBalancedLoadsHoldFindsItsEquilibrium) {
  constexpr double sigma = 100, nu = 0.25, a = 0.2, volume = std::numbers::pi / 4;
  const double whole = sigma * sigma * volume / (2 * E),
               crack = 8 * (1 - nu * nu) * sigma * sigma * a * a * a / (3 * E);
  for (const std::string law : {"small strain", "corotational"}) {
    const Trial cylinder(free_cylinder(law, sigma, sigma));
    const double net = cylinder.last("force of up z") + cylinder.last("force of down z");
    EXPECT_GT(std::abs(net), 1e-3 * sigma * volume) << "else this tests nothing";
    EXPECT_NEAR(cylinder.last("elastic energy") / (whole + crack), 1, 0.1) << law;
    EXPECT_LT(cylinder.last("largest displacement"), 2 * sigma / E);
    EXPECT_NEAR(cylinder.series("elastic energy")[1] / cylinder.last("elastic energy"), 1, 1e-6)
      << "a second step stays there";
  }
}

TEST(StaticScene, LoadsOutOfBalanceOnABodyThatNothingHoldsAreRefused) {
  try {
    const Trial cylinder(free_cylinder("small strain", 100, 50));
    FAIL() << "it has no equilibrium";
  } catch (const NumericalError& error) {
    EXPECT_NE(std::string(error.what()).find("nothing resists the translation along z"), std::string::npos)
      << error.what();
    EXPECT_NE(std::string(error.what()).find("not in balance"), std::string::npos) << error.what();
  }
}

} // namespace
} // namespace kerf::scene::statics_scenes_test
