// Tools as a scene writes them: scissors, curved blades, forceps; what they do, and what is refused.

#include "base/error.h"
#include "scene/drawing.h"
#include "tests/scene/worlds.h"

#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace kerf::scene::tools_test {
namespace {

/// "Kind name" with one key a semicolon-free item.
std::string section(const std::string& heading, const std::vector<std::string>& keys) {
  std::string text = "subsection " + heading + "\n";
  for (const std::string& key : keys)
    text += "  set " + key + "\n";
  return text + "end\n";
}

/// The keys with one of them left out, or written otherwise.
std::vector<std::string> with(std::vector<std::string> keys, const std::string& name, const std::string& value) {
  std::erase_if(keys, [&](const std::string& key) { return key.starts_with(name + " ="); });
  if (!value.empty())
    keys.push_back(name + " = " + value);
  return keys;
}

/// Close across the whole cube in the plane z = 0.003, from beside it, within the five steps.
const std::vector<std::string> shears = {"Pivot [m] = 0.2, 0, 0.003",
                                         "Axis [1] = 0, 0, 2",
                                         "Edge [m] = 0.19, 0, 0.003; -0.2, 0, 0.003",
                                         "Spine [m] = 0, 0.02, 0",
                                         "Opening times [s] = 0, 0.05",
                                         "Openings [degrees] = 120, 0",
                                         "Times [s] = 0",
                                         "Positions [m] = 0, 0, 0"};

/// Hold the upper layers of nodes from the second to the fourth step, and carry them up while they turn.
const std::vector<std::string> tweezers = {"Region = box",
                                           "Lower [m] = -1, -1, 0.06",
                                           "Upper [m] = 1, 1, 1",
                                           "Grip time [s] = 0.01",
                                           "Release time [s] = 0.04",
                                           "Times [s] = 0, 0.01, 0.05",
                                           "Positions [m] = 0.3, 0, 0.2; 0, 0.01, 0.1; 0, 0.01, 0.12",
                                           "Rotations [degrees] = 0, 0, 0; 10, 0, 0; 10, 0, 60"};

void expect_refused(const std::string& text, const std::vector<std::string>& words) {
  try {
    world_of(cube_scene() + text);
    ADD_FAILURE() << "accepted:\n" << text;
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_EQ(message.find("scene.prm:"), 0u) << message;
    for (const std::string& word : words)
      EXPECT_NE(message.find(word), std::string::npos) << "'" << word << "' is not in: " << message;
  }
}

TEST(ScissorsScene, AreTwoBladesWithTheirOwnLabels) {
  const World world = world_of(cube_scene() + falling_blade() + section("Scissors shears", shears));
  ASSERT_EQ(world.blades.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_EQ(world.blades[i].label, i + 1);
  EXPECT_EQ(world.blades[1].name, "shears first");
  EXPECT_EQ(world.blades[2].name, "shears second");
  EXPECT_EQ(world.blades[1].spine, Vec3(-world.blades[2].spine));
  EXPECT_EQ(world.blades[1].hinge->axis, Vec3::UnitZ().eval());
  EXPECT_EQ(world.bodies[0].cutter->counts().n_cut_edges.size(), 3u);
  ASSERT_EQ(world.scissors.size(), 1u);
  EXPECT_EQ(world.scissors[0].first_blade, 1u);
}

TEST(ScissorsScene, PartWhatLiesBetweenThem) {
  World world =
    world_of(cube_scene() + section("Scissors shears", shears), {"Time/End time [s]=0.1"}); // some cuts wait
  const output::TemporaryFolder folder;
  run_silently(world, folder / "out");
  const Body& body = world.bodies[0];
  EXPECT_EQ(grid::n_pieces(body.solid.complex), 2u);
  EXPECT_EQ(value(body, "cut edges"), 16) << "those across the plane, once each";
  EXPECT_GT(body.cutter->counts().n_cut_edges[0], 0u);
  EXPECT_EQ(body.cutter->counts().n_cut_edges[0], body.cutter->counts().n_cut_edges[1])
    << "the cube lies in the middle";
}

TEST(ScissorsScene, DoNotCutWhileTheyOpenOrMove) {
  const auto opening = with(shears, "Openings [degrees]", "0, 120");
  auto moving = with(shears, "Openings [degrees]", "40, 40");
  moving = with(with(moving, "Times [s]", "0, 0.05"), "Positions [m]", "0, 0, -0.2; 0, 0, 0.2");
  for (const auto& keys : {opening, moving}) {
    World world = world_of(cube_scene() + section("Scissors shears", keys));
    const output::TemporaryFolder folder;
    run_silently(world, folder / "out");
    EXPECT_EQ(value(world.bodies[0], "cut edges"), 0);
  }
}

TEST(ScissorsScene, AreDrawnWithBothBladesAndHandles) {
  const World bare = world_of(cube_scene() + section("Scissors shears", shears));
  EXPECT_EQ(drawing(bare, 0).blades.size(), 2u);
  EXPECT_TRUE(drawing(bare, 0).rods.empty());
  const World world = world_of(cube_scene() + section("Scissors shears", with(shears, "Handle [m]", "0.1")));
  EXPECT_EQ(drawing(world, 0).rods.size(), 5u) << "a shank and a ring each, and the pin";
  for (const int step : {0, 3})
    for (const render::DrawnRod& rod : drawing(world, step).rods)
      for (const Vec3& p : rod.path)
        EXPECT_LT((p - Vec3(0.2, 0, 0.003)).norm(), 0.13);
}

TEST(ScissorsScene, RefusesWhatAreNoScissors) {
  const auto refuse = [](const std::string& key, const std::string& value, const std::vector<std::string>& words) {
    SCOPED_TRACE(key + " = " + value);
    expect_refused(section("Scissors shears", with(shears, key, value)), words);
  };
  refuse("Pivot [m]", "", {"Scissors shears", "Pivot [m]", "must be"});
  refuse("Pivot [m]", "1, 2", {"Pivot [m]", "three numbers"});
  refuse("Axis [1]", "", {"Axis [1]"});
  refuse("Axis [1]", "0, 0, 0", {"Axis [1] = '0, 0, 0'", "must be a direction", "turns on"});
  refuse("Edge [m]", "0, 0, 0", {"Edge [m] = '0, 0, 0'", "at least two points", "ends"});
  refuse("Edge [m]", "0, 0, 0; 1, 0, 0; 1, 0, 0", {"Edge [m]", "must differ from the point before it", "Remove"});
  refuse("Second edge [m]", "0, 0, 0; 0, 0, 0", {"Second edge [m] = '0, 0, 0; 0, 0, 0'", "must differ"});
  refuse("Openings [degrees]", "180, 0", {"Openings [degrees] = '180, 0'", ">= 0 and < 180"});
  refuse("Openings [degrees]", "20, -1", {"Openings [degrees] = '20, -1'", ">= 0 and < 180"});
  refuse("Openings [degrees]", "20", {"Openings [degrees] = '20'", "as many as Opening times [s], which are 2"});
  refuse("Opening times [s]", "0.05, 0", {"Opening times [s] = '0.05, 0'", "times must increase", "Sort"});
  refuse("Times [s]", "0, 1", {"Positions [m]", "as many as Times [s], which are 2"});
  refuse("Positions [m]", "9, 9, 9", {"Scissors shears", "never comes near a body"});
  const auto keys = with(with(shears, "Times [s]", "1, 0"), "Positions [m]", "0, 0, 0; 0, 0, 0");
  expect_refused(section("Scissors shears", keys), {"Times [s] = '1, 0'", "times must increase"});
}

TEST(BladeScene, RefusesWhatIsNoBlade) {
  const std::vector<std::string> keys = {"Edge [m] = -0.2, 0, 0; 0.2, 0, 0", "Times [s] = 0, 0.02, 0.05",
                                         "Positions [m] = 0, 0, 0.2; 0, 0, 0; 0, 0, -0.2",
                                         "Rotations [degrees] = 0, 0, 0; 0, 0, 10; 0, 0, 20"};
  EXPECT_EQ(world_of(cube_scene() + section("Blade knife", keys)).blades.size(), 1u);
  const auto refuse = [&](const std::string& key, const std::string& value, const std::vector<std::string>& words) {
    SCOPED_TRACE(key + " = " + value);
    auto all = words;
    all.insert(all.end(), {"scene.prm:", "Blade knife/" + key + " = '" + value + "'"});
    expect_refused(section("Blade knife", with(keys, key, value)), all);
  };
  refuse("Edge [m]", "0, 0, 0", {"at least two points", "Write the ends"});
  refuse("Edge [m]", "0, 0, 0; 0, 0, 0", {"must differ from the point before it", "Remove it"});
  refuse("Edge [m]", "0, 0, 0; 1, 0, 0; 1, 0, 0; 2, 0, 0", {"must differ from the point before it", "Remove it"});
  refuse("Edge [m]", "nan, 0, 0; 1, 0, 0", {"must be points x, y, z; x, y, z, all finite"});
  refuse("Edge [m]", "0, 0; 1, 0", {"must be points x, y, z; x, y, z, all finite"});
  refuse("Times [s]", "0, 0.05, 0.02", {"times must increase", "Sort"});
  refuse("Times [s]", "0, 0.02, 0.02", {"times must increase", "remove repeated times"});
  refuse("Positions [m]", "0, 0, 0.2; 0, 0, 0", {"as many as Times [s], which are 3"});
  refuse("Positions [m]", "0, 0, 0.2; 0, 0, 0; inf, 0, 0", {"all finite"});
  refuse("Rotations [degrees]", "0, 0, 0; 0, 0, 10; 0, 0, 195", {"less than 180 degrees", "Add a key frame"});
}

/// A long straight blade that turns on its way leaves the helicoid that it sweeps: what it crosses, and what is placed
/// between, by its normals.
TEST(BladeScene, ThatTurnsLeavesItsOwnSurface) {
  const std::string knife =
    section("Blade knife", {"Edge [m] = 0, -0.7, 0; 0, 0.7, 0", "Times [s] = 0, 0.2",
                            "Positions [m] = 0, 0, 0.26; 0, 0, -0.26", "Rotations [degrees] = 0, 0, 0; 0, 0, 30"});
  World world = world_of(cube_scene() + knife,
                         {"Body cube/Cube edge [m]=0.0271", "Time/Time step [s]=0.00125", "Time/End time [s]=0.2"});
  const output::TemporaryFolder folder;
  run_silently(world, folder / "out");
  const Body& body = world.bodies[0];
  EXPECT_EQ(body.pieces.n_pieces, 2u);
  double farthest = 0;
  for (std::size_t i = 0; i < body.surface.triangles.size(); ++i)
    if (body.surface.labels[i] == 1)
      for (const auto v : body.surface.triangles[i]) {
        const Vec3& p = body.surface.rest[v];
        const double angle = 30 * std::numbers::pi / 180 * (0.26 - p[2]) / 0.52;
        farthest = std::max(farthest, std::abs(p[0] * std::cos(angle) + p[1] * std::sin(angle)));
      }
  EXPECT_LT(farthest, 0.1 * body.solid.grid.h()); // .38 with an edge of one piece
}

TEST(CurvedBlade, IsWrittenAsArcs) {
  const std::vector<std::string> keys = {"Edge [m] = -0.07, 0, 0; 0, 0, -0.07; 0.07, 0, 0", "Edge form = arcs",
                                         "Times [s] = 0, 0.05", "Positions [m] = 0, -0.15, 0.1; 0, 0.15, 0.1"};
  World world = world_of(cube_scene() + section("Blade gouge", keys));
  EXPECT_EQ(world.blades.at(0).edge.size(), 37u);
  const output::TemporaryFolder folder;
  run_silently(world, folder / "out");
  EXPECT_EQ(grid::n_pieces(world.bodies[0].solid.complex), 2u) << "it carves a gutter along the upper side";
  const auto refuse = [&](const std::string& edge, const std::string& rule) {
    expect_refused(section("Blade gouge", with(keys, "Edge [m]", edge)),
                   {"scene.prm:", "Blade gouge/Edge [m] = '" + edge + "'", rule});
  };
  refuse("0, 0, 0; 1, 0, 0", "must have three points");
  refuse("0, 0, 0; 1, 0, 0; 1, 0, 0", "three different points");
  refuse("0, 0, 0; 2, 0, 0; 1, 0, 0", "not between the others");
  expect_refused(section("Blade gouge", with(keys, "Edge form", "spline")), {"'spline'", "one of polyline, arcs"});
}

/// What a run does to forceps, step by step, without files.
void step_once(World& world, const int step) {
  Timings timings;
  const double dt = world.time_step;
  for (Body& body : world.bodies) {
    if (body.cutter)
      recut(body, world.blades, (step - 1) * dt, step * dt, timings);
    hold(body, world.forceps, step, (step - 1) * dt);
    body.report = body.physics->step(body.state, body.loads, dt);
  }
}

/// Where the corners of each grid node are, by node: all of them in one place, if they are held.
std::map<std::uint32_t, Points> places_of_held_nodes(const Body& body) {
  std::map<std::uint32_t, Points> places;
  for (const auto c : ids<grid::CornerId>(body.solid.complex.n_corners()))
    if (body.solid.grid.position(body.solid.complex.node[c])[2] >= 0.06)
      places[body.solid.complex.node[c].value].push_back(body.state.x[c.value]);
  return places;
}

/// The body quivers and is parted by a blade while it is held: what is gripped moves rigidly from where it was.
TEST(Forceps, CarryWhatTheyHoldRigidlyAcrossCuts) {
  for (const std::string integrator : {"implicit Euler", "symplectic Euler"}) {
    SCOPED_TRACE(integrator);
    World world =
      world_of(cube_scene() + falling_blade() + section("Forceps tweezers", tweezers),
               {"Body cube/Integrator=" + integrator, "Blade knife/Times [s]=0.01, 0.04", "Time/End time [s]=0.08"});
    ASSERT_EQ(world.forceps.size(), 1u);
    Body& body = world.bodies[0];
    set_in_motion(body, Vec3(0.1, 0, 0), 0.05);
    std::map<std::uint32_t, Points> gripped;
    const std::size_t n_corners = body.solid.complex.n_corners();
    for (int step = 1; step <= 8; ++step) {
      if (step == 2)
        gripped = places_of_held_nodes(body);
      const Points before = body.state.x;
      step_once(world, step);
      const bool held = step >= 2 && step <= 4;
      EXPECT_EQ(body.loads.supports.size(), held ? 1u : 0u) << step;
      if (!held)
        continue;
      const cut::Pose from = cut::pose(world.forceps[0].key_frames, 0.01),
                      to = cut::pose(world.forceps[0].key_frames, step * 0.01);
      for (const auto& [node, places] : places_of_held_nodes(body))
        for (const Vec3& x : places) {
          const Vec3 local = from.rotation.transpose() * (gripped.at(node).front() - from.position);
          EXPECT_LT((x - to(local)).norm(), 1e-15) << "step " << step;
        }
    }
    EXPECT_GT(body.solid.complex.n_corners(), n_corners) << "the blade has made new corners";
    EXPECT_EQ(grid::n_pieces(body.solid.complex), 2u);
  }
}

/// Free fall after the release: the middle of a cube that was held as a whole keeps the tool's velocity.
TEST(Forceps, ReleaseWithTheirVelocity) {
  const auto all = with(with(tweezers, "Lower [m]", "-1, -1, -1"), "Rotations [degrees]", "");
  World world = world_of(cube_scene() + section("Forceps tweezers", all), {"Time/End time [s]=0.08"});
  Body& body = world.bodies[0];
  for (int step = 1; step <= 4; ++step)
    step_once(world, step);
  const Vec3 carried(0, 0, 0.5); // [m/s]
  for (int step = 5; step <= 8; ++step) {
    const Points before = body.state.x;
    step_once(world, step);
    for (std::size_t i = 0; i < before.size(); ++i)
      EXPECT_LT((body.state.x[i] - before[i] - 0.01 * carried).norm(), 1e-12) << step;
  }
}

/// While it is held, the rest of the body follows: nothing but the forceps moves it.
TEST(Forceps, DragTheRestOfTheBody) {
  World world = world_of(cube_scene() + section("Forceps tweezers", tweezers));
  Body& body = world.bodies[0];
  double lowest = 1;
  for (int step = 1; step <= 4; ++step)
    step_once(world, step);
  for (const Vec3& x : body.state.x)
    lowest = std::min(lowest, x[2]);
  EXPECT_GT(value(body, "elastic energy"), 0);
  EXPECT_GT(value(body, "kinetic energy"), 0);
  EXPECT_LT(lowest, 0);
}

TEST(Forceps, ComeAfterTheSupportsOfTheBody) {
  World world = world_of(cube_scene() + section("Forceps tweezers", tweezers),
                         {"Body cube/Support floor/Lower [m]=-1,-1,-1", "Body cube/Support floor/Upper [m]=1,1,-0.06"});
  Body& body = world.bodies[0];
  for (int step = 1; step <= 5; ++step) {
    step_once(world, step);
    ASSERT_EQ(body.loads.supports.size(), step == 1 || step == 5 ? 1u : 2u) << "step " << step;
    for (const auto corner : body.loads.supports[0].corners)
      EXPECT_LT(
        (body.state.x[corner] - body.solid.grid.position(body.solid.complex.node[grid::CornerId(corner)])).norm(),
        1e-15);
  }
}

TEST(Forceps, HoldASphere) {
  const std::vector<std::string> ball = {"Region = sphere",         "Centre [m] = 0.075, 0.075, 0.075",
                                         "Radius [m] = 0.051",      "Times [s] = 0",
                                         "Positions [m] = 0, 0, 0", "Jaws [m] = 0, 0.01, 0",
                                         "Handle [m] = 0, 0, 0.1"};
  World world = world_of(cube_scene() + section("Forceps tip", ball));
  step_once(world, 1);
  const auto& supports = world.bodies[0].loads.supports;
  ASSERT_EQ(supports.size(), 1u);
  EXPECT_EQ(supports[0].corners.size(), 7u) << "a node and its six neighbours, 0.05 m away";
  EXPECT_EQ(drawing(world, 1).rods.size(), 4u) << "two arms and two jaws";
}

/// A tool of whose looks the scene says nothing has a size, and stands clear of what it works on.
TEST(ToolShapes, WhatNobodyDescribesIsDrawn) {
  const World world =
    world_of(cube_scene() +
             section("Blade knife", {"Edge [m] = 0, -0.2, 0; 0, 0.2, 0", "Times [s] = 0, 0.05",
                                     "Positions [m] = 0.003, 0, 0.13; 0.003, 0, -0.13"}) +
             section("Scissors shears", with(shears, "Spine [m]", "")) + section("Forceps tweezers", tweezers));
  EXPECT_LT((world.blades[0].spine - Vec3(0, 0, 0.08)).norm(), 1e-12) << "it falls, and is 0.4 m long";
  EXPECT_LT((world.blades[1].spine - Vec3(0, -0.039, 0)).norm(), 1e-12) << "the first blade opens towards -y";
  EXPECT_EQ(world.blades[1].spine, Vec3(-world.blades[2].spine));
  const auto rods = drawing(world, 3).rods;
  ASSERT_EQ(rods.size(), 4u) << "two arms and two jaws";
  EXPECT_GT((rods[0].path.back() - rods[2].path.back()).norm(), 0.1);
  for (const auto& rod : rods)
    EXPECT_GT(rod.path.front()[2], 0.1) << "above the cube, whose upper layers they hold";
}

TEST(Forceps, AreDrawnOpenUntilTheyGrip) {
  auto keys = with(with(tweezers, "Jaws [m]", "0, 0.01, 0"), "Handle [m]", "0, 0, 0.1");
  const World world = world_of(cube_scene() + section("Forceps tweezers", keys));
  const auto gap = [&](const int step) {
    const auto rods = drawing(world, step).rods;
    return (rods.at(1).path.back() - rods.at(3).path.back()).norm();
  };
  EXPECT_NEAR(gap(2), 0.02, 1e-12);
  EXPECT_NEAR(gap(4), 0.02, 1e-12);
  EXPECT_GT(gap(1), 0.04);
  EXPECT_GT(gap(5), 0.04);
}

TEST(Forceps, SayWhatIsWrong) {
  const auto refuse = [](const std::string& key, const std::string& value, const std::vector<std::string>& words) {
    SCOPED_TRACE(key + " = " + value);
    expect_refused(section("Forceps tweezers", with(tweezers, key, value)), words);
  };
  refuse("Region", "", {"Forceps tweezers", "Region"});
  refuse("Region", "cone", {"'cone'", "one of box, half space, sphere, mesh"});
  refuse("Region", "sphere", {"the region 'sphere' must have the key 'Centre [m]'"});
  refuse("Radius [m]", "1", {"Radius [m]", "the region 'box' does not read this key", "Lower [m], Upper [m]"});
  refuse("Upper [m]", "1, 1, -2", {"Upper [m] = '1, 1, -2'", "must not be below Lower", "Swap"});
  refuse("Upper [m]", "1, 1, 0.061", {"Forceps tweezers", "holds no corner or phyxel", "rest configuration"});
  refuse("Grip time [s]", "0.05", {"Grip time [s] = '0.05'", "before the last step, which begins at 0.04 s"});
  refuse("Grip time [s]", "-1", {"Grip time [s] = '-1'", "must be >= 0"});
  refuse("Release time [s]", "0.01", {"Release time [s] = '0.01'", "at least a step after Grip time [s]"});
  refuse("Times [s]", "0, 0.02, 0.01", {"Times [s] = '0, 0.02, 0.01'", "times must increase", "Sort"});
  refuse("Times [s]", "0, 0.02", {"Positions [m]", "as many as Times [s], which are 2"});
  refuse("Rotations [degrees]", "0, 0, 0; 0, 0, 190; 0, 0, 0",
         {"Rotations [degrees] = '0, 0, 0; 0, 0, 190; 0, 0, 0'", "less than 180 degrees"});
}

} // namespace
} // namespace kerf::scene::tools_test
