// A scene names what exists; what it does not name is not built.

#include "dynamics/bdf2.h"
#include "dynamics/explicit_steppers.h"
#include "dynamics/generalised_alpha.h"
#include "dynamics/implicit_euler.h"
#include "dynamics/sound_steps.h"
#include "dynamics/symplectic_euler.h"
#include "physics/on_corners.h"
#include "tests/output/samples.h"
#include "tests/scene/worlds.h"
#include "tests/support/checkout.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

namespace kerf::scene::compose_test {
namespace {

constexpr std::array optional_kinds = {"Gravity", "Blade", "Observables", "Surface file", "Images"};

bool says(const World& world, const std::string& start) {
  return std::any_of(world.composition.begin(), world.composition.end(),
                     [&](const std::string& line) { return line.starts_with(start); });
}

TEST(Compose, BuildsNothingThatTheSceneDoesNotWrite) {
  const World world = world_of(cube_scene());
  EXPECT_FALSE(world.images);
  EXPECT_FALSE(world.surface_file);
  EXPECT_TRUE(world.bodies.at(0).observables.empty());
  EXPECT_EQ(world.bodies[0].accounts, nullptr);
  EXPECT_TRUE(world.blades.empty());
  ASSERT_EQ(world.bodies.size(), 1u);
  EXPECT_EQ(world.bodies[0].cutter, nullptr);
  EXPECT_TRUE(world.bodies[0].loads.supports.empty());
  EXPECT_EQ(world.bodies[0].loads.gravity, Vec3(Vec3::Zero()));
  for (const char* kind : optional_kinds)
    EXPECT_TRUE(says(world, std::string("left out: ") + kind)) << kind;
}

TEST(Compose, BuildsWhatTheSceneWrites) {
  const World world = world_of(cube_scene() + falling_blade() + all_outputs());
  EXPECT_TRUE(world.images && world.images->renderer);
  EXPECT_TRUE(world.surface_file);
  EXPECT_EQ(world.bodies.at(0).observables.size(), 7u);
  EXPECT_EQ(world.n_steps, 5);
  ASSERT_EQ(world.blades.size(), 1u);
  ASSERT_NE(world.bodies.at(0).cutter, nullptr);
  EXPECT_EQ(world.bodies[0].cutter->counts().n_cut_edges, std::vector<std::size_t>{0});
  EXPECT_EQ(world.bodies[0].loads.gravity, Vec3(0, 0, -9.81));
  for (const char* kind : optional_kinds)
    EXPECT_FALSE(says(world, std::string("left out: ") + kind)) << kind;
  EXPECT_TRUE(says(world, "blade knife"));
  EXPECT_TRUE(says(world, "body cube"));
  EXPECT_TRUE(says(world, "images"));
}

TEST(Compose, EveryBodyOfASceneWithABladeCanBeCut) {
  const std::string second =
    "subsection Body other\n  set Mesh = " + mesh_path("cube.off") + "\n  set Cube edge [m] = 0.1\nend\n";
  const World world = world_of(cube_scene() + second + falling_blade());
  ASSERT_EQ(world.bodies.size(), 2u);
  EXPECT_EQ(world.bodies[1].name, "other");
  for (const Body& body : world.bodies)
    EXPECT_NE(body.cutter, nullptr) << body.name;
}

TEST(Compose, TakesTheIntegratorThatIsNamed) {
  const auto is = [](const std::string& name, const auto& made) {
    const World world = world_of(cube_scene(), {"Body cube/Integrator=" + name});
    const auto& elements = dynamic_cast<const physics::Elements&>(*world.bodies.at(0).physics);
    return made(dynamic_cast<const dynamics::SoundSteps&>(elements.stepper()).watched());
  };
  const auto kind = []<class Kind>(const Kind*) {
    return [](const dynamics::Stepper& stepper) { return dynamic_cast<const Kind*>(&stepper) != nullptr; };
  };
  EXPECT_TRUE(is("implicit Euler", kind(static_cast<dynamics::ImplicitEuler*>(nullptr))));
  EXPECT_TRUE(is("BDF2", kind(static_cast<dynamics::Bdf2*>(nullptr))));
  EXPECT_TRUE(is("Newmark", kind(static_cast<dynamics::GeneralisedAlpha*>(nullptr))));
  EXPECT_TRUE(is("generalised alpha", kind(static_cast<dynamics::GeneralisedAlpha*>(nullptr))));
  EXPECT_TRUE(is("symplectic Euler", kind(static_cast<dynamics::SymplecticEuler*>(nullptr))));
  EXPECT_TRUE(is("velocity Verlet", kind(static_cast<dynamics::VelocityVerlet*>(nullptr))));
  EXPECT_TRUE(is("explicit Euler", kind(static_cast<dynamics::ExplicitEuler*>(nullptr))));
  EXPECT_TRUE(is("midpoint Runge-Kutta", kind(static_cast<dynamics::MidpointRungeKutta*>(nullptr))));
}

/// Five cubes high: what the lowest corners carry brakes them by mu g 5 at most; .001 m/s of that takes 41 microseconds.
TEST(Compose, WarnsOfFrictionThatExplicitStepsDoNotResolve) {
  const auto warns = [](const std::string& integrator, const std::string& step, const std::string& friction) {
    const std::string floor = "subsection Floor ground\n  set Point [m] = 0, 0, -1\nend\n";
    const World world = world_of(cube_scene() + "subsection Gravity\nend\n" + floor,
                                 {"Body cube/Integrator=" + integrator, "Time/Time step [s]=" + step,
                                  "Time/End time [s]=" + step, "Floor ground/Friction [1]=" + friction});
    return says(world, "warning: body cube: steps of " + step + " s are too long for the friction of floor ground");
  };
  EXPECT_TRUE(warns("velocity Verlet", "5e-05", "0.5"));
  EXPECT_FALSE(warns("velocity Verlet", "3e-05", "0.5"));
  EXPECT_FALSE(warns("velocity Verlet", "5e-05", "0"));
  EXPECT_FALSE(warns("Newmark", "0.01", "0.5"));
}

TEST(Compose, IntegratesOverOctantsOrFullCubes) {
  const double cube_mass = 1000 * 0.2 * 0.2 * 0.2;
  EXPECT_NEAR(value(world_of(cube_scene()).bodies.at(0), "mass"), cube_mass, 1e-12 * cube_mass);
  const World full = world_of(cube_scene(), {"Body cube/Integration=full cube"});
  EXPECT_NEAR(value(full.bodies.at(0), "mass"), 1000 * 0.25 * 0.25 * 0.25, 1e-9); // 5 cells an edge touch material
}

TEST(Compose, TakesTheLawAndTheElementThatAreNamed) {
  const auto model_of = [](const std::vector<std::string>& settings) {
    World world = world_of(cube_scene(), settings);
    EXPECT_TRUE(
      says(world, "body cube: " + std::string(settings.empty() ? "corotational trilinear" : "neo-Hookean enhanced")));
    return std::move(world.bodies.at(0).physics);
  };
  const auto by_default = model_of({});
  const auto named = model_of({"Body cube/Material/Law=neo-Hookean", "Body cube/Element=enhanced"});
  const auto& plain = dynamic_cast<const fem::Hexahedra&>(by_default->model());
  const auto& other = dynamic_cast<const fem::Hexahedra&>(named->model());
  EXPECT_TRUE(std::holds_alternative<material::Corotational>(plain.law()));
  EXPECT_TRUE(std::holds_alternative<material::NeoHookean>(other.law()));
  const World fractions = world_of(cube_scene(), {"Body cube/Integration=volume fraction"});
  EXPECT_NEAR(value(fractions.bodies.at(0), "mass"), 1000 * 0.2 * 0.2 * 0.2, 1e-11);
}

TEST(Compose, AMeshPathStartsAtTheScene) {
  const std::string file = support::checkout() + "/params/here.prm";
  const World world = compose(scan_scene_text(cube_scene(), file, {"Body cube/Mesh=meshes/cube.off"}));
  EXPECT_NEAR(world.bodies.at(0).mesh_volume, 0.008, 1e-15);
}

TEST(Compose, SupportsHoldTheirNodesAndMoveThem) {
  World world =
    world_of(cube_scene(), {"Body cube/Support top/Lower [m]=-1,-1,0.06", "Body cube/Support top/Upper [m]=1,1,1",
                            "Body cube/Support top/Displacement [m]=t; 2*t; sin(pi*t)"});
  const dynamics::Loads& loads = world.bodies.at(0).loads;
  ASSERT_EQ(loads.supports.size(), 1u);
  EXPECT_EQ(loads.supports[0].corners.size(), 2u * 6 * 6); // the layers at 0.075 and above the skin, at 0.125
  for (const Vec3& X : loads.supports[0].rest)
    EXPECT_GT(X[2], 0.06);
  EXPECT_LT((loads.supports[0].displacement(0.5) - Vec3(0.5, 1, 1)).norm(), 1e-15);
}

/// Two boxes with edges of .3 m, a distance of .2 m apart along x, and a bar with edges of `width` [m] between them.
std::string dumbbell(const double width) {
  std::ostringstream text;
  constexpr int n_rings = 6;
  text << "OFF\n" << 4 * n_rings << ' ' << 8 * (n_rings - 1) + 4 << " 0\n";
  for (const auto& [x, edge] : {std::pair(0.0, 0.3), {0.3, 0.3}, {0.3, width}, {0.5, width}, {0.5, 0.3}, {0.8, 0.3}})
    for (const auto& [y, z] : {std::pair(-1, -1), {1, -1}, {1, 1}, {-1, 1}})
      text << x << ' ' << 0.5 * edge * y << ' ' << 0.5 * edge * z << '\n';
  for (int first = 0; first < 4 * (n_rings - 1); first += 4)
    for (int k = 0; k < 4; ++k) {
      const int a = first + k, b = first + (k + 1) % 4;
      text << "3 " << a << ' ' << b << ' ' << b + 4 << "\n3 " << a << ' ' << b + 4 << ' ' << a + 4 << '\n';
    }
  const int last = 4 * (n_rings - 1);
  text << "3 0 2 1\n3 0 3 2\n3 " << last << ' ' << last + 1 << ' ' << last + 2 << "\n3 " << last << ' ' << last + 2
       << ' ' << last + 3 << '\n';
  return text.str();
}

TEST(Compose, WarnsOfPiecesThatTheMeshDoesNotHave) {
  const output::TemporaryFolder folder;
  const std::string file = (folder / "dumbbell.off").string();
  for (const auto& [width, is_parted] : {std::pair(0.12, false), {0.01, true}}) {
    std::ofstream(file) << dumbbell(width);
    const World world = world_of(cube_scene(), {"Body cube/Mesh=" + file, "Body cube/Cube edge [m]=0.04"});
    EXPECT_EQ(world.bodies.at(0).pieces.n_pieces, is_parted ? 2u : 1u);
    EXPECT_EQ(says(world, "warning: body cube: 2 pieces on this grid, of a mesh of 1 shell"), is_parted);
  }
}

TEST(Compose, WarnsOfSupportsThatHoldAll) {
  const std::string all = "Body cube/Support all/Lower [m]=-1,-1,-1", upper = "Body cube/Support all/Upper [m]=1,1,1",
                    words = "warning: body cube: its supports hold all";
  EXPECT_TRUE(says(world_of(cube_scene(), {all, upper}), words));
  EXPECT_FALSE(says(world_of(cube_scene(), {all, upper, "Body cube/Support all/Hold=y"}), words));
}

TEST(Compose, WarnsOfBladesThatComeTooLate) {
  const auto warns = [](const std::string& times) {
    return says(world_of(cube_scene() + section("Blade knife", {"Edge [m] = -0.05, -1, 0; -0.05, 1, 0", times,
                                                                "Positions [m] = 0, 0, 0; 0.1, 0, 0"})),
                "warning: blade knife: its first key frame is at 500 s");
  };
  EXPECT_TRUE(warns("Times [s] = 500, 501"));
  EXPECT_FALSE(warns("Times [s] = 0, 501"));
}

TEST(Compose, EveryObservableHasUnitAndSourceAndIsFinite) {
  std::string names;
  for (const Observable& o : body_observables()) {
    names += (names.empty() ? "" : ", ") + o.name;
    EXPECT_FALSE(o.unit.empty()) << o.name;
    EXPECT_FALSE(o.source.empty()) << o.name;
  }
  const World world = world_of(cube_scene(), {"Observables/Names=" + names});
  ASSERT_EQ(world.bodies.at(0).observables.size(), body_observables().size());
  for (const Observable& o : world.bodies[0].observables)
    EXPECT_TRUE(std::isfinite(o.value(world.bodies[0]))) << o.name;
  EXPECT_EQ(find_observable("no such thing"), nullptr);
}

} // namespace
} // namespace kerf::scene::compose_test
