// Supports that hold the skin: closed forms for grids that stand anywhere in the body, and what is refused.

#include "dynamics/skin_support.h"
#include "base/error.h"
#include "tests/scene/trials.h"

#include <numbers>

namespace kerf::scene::skin_support_test {
namespace {

constexpr double E = 1e5; // [Pa]
const Keys at_skin = {"Hold at = skin"};
const Keys left = box("-1, -1, -1", "0.001, 1, 1"), right = box("0.999, -1, -1", "2, 1, 1");
const Keys below = box("-1, -1, -1", "1, 1, -0.0999"), above = box("-1, -1, 0.0999", "1, 1, 1");

std::string probe(const std::string& name, const std::string& point) {
  return section("Probe " + name, {"Point [m] = " + point});
}

/// Of the forces at the start, which those of skins that are far from their place make large.
const std::string exactly = section("Quasi-static", {"Newton tolerance [1] = 1e-10"});

/// The cube of 0.2 m in cubes of 0.04 m, one static step.
std::string static_cube(const std::string& offset, const std::string& inside, const std::string& names) {
  const Keys keys = {"Mesh = " + mesh_path("cube.off"), "Cube edge [m] = 0.04", "Lattice offset [1] = " + offset};
  return steps(1, 1) + section("Body cube", keys + statics(), exactly + inside) + observe(names);
}

/// The bar [0, 1] x [0, 0.2]^2 m, one static step.
std::string static_bar(const double h, const std::string& offset, const std::string& inside, const std::string& names,
                       const int n_steps = 1) {
  const Keys keys = {"Mesh = " + mesh_path("bar.off"), key("Cube edge [m]", h), "Lattice offset [1] = " + offset,
                     "Element = enhanced"};
  return steps(1, n_steps) + section("Body bar", keys + statics(), exactly + inside) + observe(names);
}

void expect_refused(const std::string& text, const Keys& words) {
  try {
    world_of(text);
    FAIL() << "accepted";
  } catch (const ParameterError& error) {
    for (const std::string& word : words)
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
  }
}

/// E A e, less what the two held faces give way: e h / c each, of 0.2 m.
TEST(SkinSupportScene, StretchedCubeIsAsLongAsItsMesh) {
  for (const std::string offset : {"0.5, 0.5, 0.5", "0.3, 0.3, 0.3"})
    for (const double c : {20., 100.}) {
      SCOPED_TRACE(offset + ", " + to_text(c));
      const Keys stiff = at_skin + Keys{key("Skin stiffness [1]", c)};
      const Trial cube(static_cube(offset,
                                   material(E, 0, "small strain") + section("Support base", below + stiff) +
                                     section("Support top", above + stiff + Keys{"Displacement [m] = 0; 0; 0.02*t"}),
                                   "load forces, energy of loads, elastic energy"));
      const double force = E * cube_face * 0.1, gives = 2 * 0.04 / c / 0.2;
      EXPECT_NEAR(cube.last("force of top z"), force / (1 + gives), 1e-3 * force);
      EXPECT_NEAR(cube.last("force of base z"), -cube.last("force of top z"), 1e-6 * force);
      EXPECT_NEAR(cube.last("energy of loads") / cube.last("elastic energy"), gives, 0.02 * gives);
      if (c == 100) {
        EXPECT_NEAR(cube.last("force of top z"), force, 0.005 * force);
      }
      EXPECT_TRUE(cube.body().regions.empty());
    }
}

/// Held along z only the ends contract freely: E A e whatever Poisson's ratio; corners hold the middle planes.
TEST(SkinSupportScene, SlidesAlongWhatItDoesNotHold) {
  const Keys middle_x = box("-0.001, -1, -1", "0.001, 1, 1"), middle_y = box("-1, -0.001, -1", "1, 0.001, 1");
  for (const std::string held : {"Hold = z", "Held direction [1] = 0, 0, 3"}) {
    const Trial cube(
      static_cube("0.5, 0.5, 0.5",
                  material(E, 0.3, "small strain") + section("Support base", below + at_skin + Keys{held}) +
                    section("Support x", middle_x + Keys{"Hold = x"}) +
                    section("Support top", above + at_skin + Keys{held, "Displacement [m] = 0; 0; 0.02"}) +
                    section("Support y", middle_y + Keys{"Hold = y"}) + probe("side", "0.09, 0, 0"),
                  "load forces, reactions, probes"));
    const double force = E * cube_face * 0.1;
    EXPECT_NEAR(cube.last("force of top z"), force, 0.005 * force);
    EXPECT_NEAR(cube.last("probe side x"), -0.3 * 0.1 * 0.09, 0.02 * 0.3 * 0.1 * 0.09);
    EXPECT_NEAR(cube.last("force of top x"), 0, 1e-12);
    ASSERT_EQ(cube.body().regions.size(), 2u);
    EXPECT_NEAR(cube.last("reaction x x"), 0, 1e-3);
    EXPECT_NEAR(cube.last("reaction y y"), 0, 1e-3);
  }
}

/// w(x) = q / (24 E I) (x^4 - 4 x^3 + 6 x^2) + q / (k G A) (x - x^2 / 2) of a length of 1 m, k = 5/6, nu = 0
/// (Timoshenko and Gere, Mechanics of Materials).
double timoshenko(const double q, const double x) {
  const double I = std::pow(0.2, 4) / 12, G = E / 2;
  return q / (24 * E * I) * x * x * (x * x - 4 * x + 6) + q / (5. / 6 * G * bar_area) * (x - x * x / 2);
}

TEST(SkinSupportScene, CantileverBendsAsTimoshenkosBeam) {
  for (const std::string offset : {"0.5, 0.5, 0.5", "0.1, 0.5, 0.5"}) {
    SCOPED_TRACE(offset);
    const Trial bar(section("Gravity", {"Acceleration [m/s^2] = 0, 0, -0.1"}) +
                    static_bar(0.05, offset,
                               material(E, 0, "small strain") + section("Support wall", left + at_skin) +
                                 probe("tip", "0.99, 0.1, 0.1"),
                               "probes, load forces"));
    const double q = 1000 * 0.1 * bar_area, w = timoshenko(q, 0.99);
    EXPECT_NEAR(-bar.last("probe tip z"), w, 0.005 * w);
    EXPECT_NEAR(bar.last("force of wall z"), q, 1e-3 * q);
  }
}

/// Halfway a twisted bar has turned by half the angle.
TEST(SkinSupportScene, TurnedEndTwistsABar) {
  const Trial bar(static_bar(
    0.05, "0.5, 0.5, 0.5",
    material(E, 0.3) + section("Support wall", left + at_skin) +
      section("Support hand", right + at_skin + Keys{"Rotation [degrees] = 10*t; 0; 0", "Pivot [m] = 1, 0.1, 0.1"}) +
      probe("end", "0.999, 0.19, 0.1") + probe("middle", "0.5, 0.19, 0.1"),
    "probes, load forces"));
  const double angle = 10 * std::numbers::pi / 180;
  EXPECT_NEAR(bar.last("probe end z"), 0.09 * std::sin(angle), 0.01 * 0.09 * angle);
  EXPECT_NEAR(bar.last("probe end y"), 0.09 * (std::cos(angle) - 1), 0.01 * 0.09 * angle);
  EXPECT_NEAR(bar.last("probe middle z"), 0.09 * std::sin(angle / 2), 0.01 * 0.09 * angle);
  EXPECT_NEAR(bar.last("force of hand z"), 0, 1e-4);
  EXPECT_NEAR(bar.last("force of hand x"), -bar.last("force of wall x"), 1e-4);
}

/// A stretched bar pulls at its ends, until it is cut through.
TEST(SkinSupportScene, HoldsWhatCutsLeave) {
  const Trial bar(
    static_bar(0.2 / 3, "0.5, 0.5, 0.5",
               material(E, 0, "small strain") + section("Support wall", left + at_skin) +
                 section("Support end", right + at_skin + Keys{"Displacement [m] = 0.01; 0; 0"}),
               "load forces, pieces", 2) +
    section("Cut surface knife", {"Time [s] = 1", "Shape = plane", "Point [m] = 0.52, 0, 0", "Normal [1] = 1, 0, 0"}));
  const double force = E * bar_area * 0.01;
  EXPECT_EQ(bar.last("pieces"), 2);
  EXPECT_NEAR(bar.series("force of end x")[1], force, 0.005 * force);
  EXPECT_NEAR(bar.last("force of end x"), 0, 1e-5 * force);
}

/// The faces that a cut reveals in its region are not held: it has the area of the bar's skin before and after.
TEST(SkinSupportScene, DoesNotHoldRevealedFaces) {
  const auto area = [](const World& world) {
    return dynamic_cast<const dynamics::SkinSupport&>(*world.bodies.at(0).loads.acting.at(0)).area();
  };
  const std::string text =
    static_bar(0.2 / 3, "0.5, 0.5, 0.5",
               material(E, 0) + section("Support all", box("-1, -1, -1", "2, 2, 2") + at_skin), "pieces", 2) +
    section("Cut surface knife", {"Time [s] = 1", "Shape = plane", "Point [m] = 0.52, 0, 0", "Normal [1] = 1, 0, 0"});
  const Trial cut(text);
  EXPECT_EQ(cut.last("pieces"), 2);
  EXPECT_NEAR(area(world_of(text)), 4 * 0.2 + 2 * bar_area, 1e-9);
  EXPECT_NEAR(area(cut.world), 4 * 0.2 + 2 * bar_area, 1e-3);
}

/// In every backend that can, a damped cube comes to hang by its top with its weight.
TEST(SkinSupportScene, CarriesTheWeightOfOtherBackends) {
  for (const std::string backend : {"fem", "mass-spring", "pba"}) {
    SCOPED_TRACE(backend);
    const Keys keys = {"Mesh = " + mesh_path("cube.off"), "Cube edge [m] = 0.05", "Backend = " + backend};
    const Trial cube(steps(0.02, 100) + section("Gravity", {"Acceleration [m/s^2] = 0, 0, -1"}) +
                     section("Body cube", keys,
                             material(E, 0.25) + section("Damping", {"Mass damping [1/s] = 20"}) +
                               section("Support top", above + at_skin)) +
                     observe("load forces"));
    EXPECT_NEAR(cube.last("force of top z"), cube_mass, 0.01 * cube_mass);
  }
}

TEST(SkinSupportScene, StaticsNamesWhatIsLeftFree) {
  const auto cube = [](const std::string& held) {
    return static_cube("0.5, 0.5, 0.5", material(E, 0) + section("Support base", below + at_skin + Keys{held}),
                       "load forces");
  };
  expect_refused(cube("Hold = z"), {"translation along x, translation along y, rotation about z"});
  expect_refused(cube("Hold = xy"), {"translation along z"});
  EXPECT_NO_THROW(world_of(cube("Hold = all")));
}

TEST(SkinSupportScene, RefusesWhatCannotHold) {
  const auto cube = [](const std::string& inside) {
    return static_cube("0.5, 0.5, 0.5", material(E, 0) + inside, "load forces");
  };
  const Keys outside = box("1, 1, 1", "2, 2, 2"), within = box("-0.09, -0.09, -0.09", "0.09, 0.09, 0.09");
  for (const Keys& region : {outside, within})
    expect_refused(cube(section("Support base", below) + section("Support air", region + at_skin)),
                   {"Body cube/Support air", "holds no triangle", "Move or enlarge it"});
  expect_refused(cube(section("Support base", below + at_skin) + section("Support void", outside)),
                 {"Body cube/Support void", "holds no corner or phyxel"});
  expect_refused(cube(section("Support base", below + Keys{"Skin stiffness [1] = 50"})),
                 {"Support base/Skin stiffness [1]", "holds corners", "set Hold at = skin"});
  const Keys lattice = {"Mesh = " + mesh_path("cube.off"), "Cube edge [m] = 0.04", "Backend = lattice"};
  expect_refused(steps(0.01, 1) + section("Body cube", lattice, section("Support base", below + at_skin)),
                 {"Support base/Hold at", "lattice", "set Hold at = corners"});
}

/// Corners before the end of the bar, corners on both sides of it, the skin.
TEST(SkinSupportScene, CornersOutsideOfTheMaterialAreWarnedOf) {
  const auto is_warned = [](const Keys& region, const std::string& offset) {
    const World world = world_of(static_bar(0.05, offset, material(E, 0) + section("Support wall", region), "pieces"));
    return std::any_of(world.composition.begin(), world.composition.end(), [](const std::string& said) {
      return said.find("all corners that support wall holds lie outside") != std::string::npos;
    });
  };
  EXPECT_TRUE(is_warned(left, "0.5, 0.5, 0.5"));
  EXPECT_FALSE(is_warned(box("-1, -1, -1", "0.03, 1, 1"), "0.5, 0.5, 0.5"));
  EXPECT_FALSE(is_warned(left + at_skin, "0.5, 0.5, 0.5"));
  EXPECT_FALSE(is_warned(left, "0.001, 0.5, 0.5"));
  EXPECT_FALSE(is_warned(left, "0, 0.5, 0.5")); // a layer of nodes on the skin itself
}

} // namespace
} // namespace kerf::scene::skin_support_test
