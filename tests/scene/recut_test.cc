// What a cut must not change: mass, momentum, energy and volume of a body; and what it must: pieces let go of each
// other.

#include "tests/scene/worlds.h"

#include <Eigen/Geometry>

#include <gtest/gtest.h>

namespace kerf::scene::recut_test {
namespace {

/// A free cube of 8 cubes an edge that is bent a little and tumbles at random, at rest for nobody but the blade.
World tumbling_world(const std::string& blade, const std::string& integration) {
  World world =
    world_of(cube_scene() + blade, {"Body cube/Cube edge [m]=0.025", "Body cube/Integration=" + integration});
  dynamics::State& state = world.bodies.at(0).state;
  const Points jitter = random_points(state.x.size(), 1e-4, 1);
  for (std::size_t i = 0; i < state.x.size(); ++i)
    state.x[i] += jitter[i];
  state.v = random_points(state.x.size(), 3, 2);
  world.bodies[0].cutter->stand(state.x); // for the blade it has not moved
  return world;
}

/// A blade so narrow, and that starts and stops so deep, that it meets no cell of the skin.
std::string inner_blade() {
  return "subsection Blade knife\n"
         "  set Edge [m]      = 0, -0.04, 0; 0, 0.04, 0.01\n"
         "  set Times [s]     = 0, 0.05\n"
         "  set Positions [m] = 0.004, 0, 0.05; -0.003, 0, -0.05\n"
         "end\n";
}

/// A slanted blade that goes all the way.
std::string long_blade() {
  return "subsection Blade knife\n"
         "  set Edge [m]      = 0, -0.2, 0; 0.01, 0.2, 0.04\n"
         "  set Times [s]     = 0, 0.05\n"
         "  set Positions [m] = 0.03, 0, 0.14; -0.02, 0, -0.14\n"
         "end\n";
}

/// A blade that goes in along one plane and on along others: fronts that it leaves ahead of a turn are taken back.
std::string turning_blade() {
  return "subsection Blade knife\n"
         "  set Edge [m]      = 0, -0.2, 0; 0.01, 0.2, 0.04\n"
         "  set Times [s]     = 0, 0.015, 0.025, 0.035, 0.05\n"
         "  set Positions [m] = 0.03, 0, 0.14; 0.025, 0, 0.06; -0.03, 0, 0.03; 0.02, 0, -0.02; -0.02, 0, -0.14\n"
         "end\n";
}

/// The blade's whole way, while the body holds still.
void cut_through(World& world) {
  Body& body = world.bodies.at(0);
  Timings timings;
  for (int step = 1; step <= world.n_steps || body.cutter->n_waiting() > 0; ++step)
    recut(body, world.blades, (step - 1) * world.time_step, step * world.time_step, timings);
}

struct Balance {
  double mass = 0, kinetic_energy = 0, rest_volume = 0;
  Vec3 momentum = Vec3::Zero(), angular_momentum = Vec3::Zero();
};

Balance balance(const Body& body) {
  Balance sum{.rest_volume = value(body, "rest volume")};
  const auto mass = body.physics->model().lumped_mass();
  for (std::size_t i = 0; i < mass.size(); ++i) {
    const Vec3 p = mass[i] * body.state.v[i];
    sum.mass += mass[i];
    sum.momentum += p;
    sum.angular_momentum += body.state.x[i].cross(p);
    sum.kinetic_energy += 0.5 * p.dot(body.state.v[i]);
  }
  return sum;
}

void expect_same(const Balance& before, const Balance& after, const double tolerance) {
  EXPECT_NEAR(after.mass, before.mass, tolerance * before.mass);
  EXPECT_NEAR(after.kinetic_energy, before.kinetic_energy, tolerance * before.kinetic_energy);
  EXPECT_NEAR(after.rest_volume, before.rest_volume, tolerance * before.rest_volume);
  EXPECT_LE((after.momentum - before.momentum).norm(), tolerance * before.momentum.norm());
  EXPECT_LE((after.angular_momentum - before.angular_momentum).norm(), tolerance * before.angular_momentum.norm());
}

bool meets_skin(const Body& body, const grid::EdgeId edge) {
  for (const grid::CellId c : body.solid.grid.cells(edge))
    if (c.valid())
      for (const grid::NodeId n : body.solid.grid.nodes(c))
        if (!body.solid.grid.is_material(n))
          return true;
  return false;
}

/// The piece that holds each corner.
std::vector<std::uint32_t> piece_of_corners(const grid::CellComplex& complex) {
  const grid::Pieces pieces = grid::pieces(complex);
  std::vector<std::uint32_t> piece(complex.n_corners(), pieces.n_pieces);
  for (const auto c : ids<grid::CopyId>(complex.n_copies()))
    for (const grid::CornerId corner : complex.copies[c].corners) {
      EXPECT_TRUE(piece[corner.value] == pieces.n_pieces || piece[corner.value] == pieces.piece[c]);
      piece[corner.value] = pieces.piece[c];
    }
  return piece;
}

TEST(Recut, ACutInsideKeepsEveryBalance) {
  for (const std::string integration : {"octants", "full cube"}) {
    SCOPED_TRACE(integration);
    World world = tumbling_world(inner_blade(), integration);
    const Body& body = world.bodies[0];
    const Balance before = balance(body);
    const std::size_t n_corners = body.solid.complex.n_corners();
    cut_through(world);

    ASSERT_GT(body.solid.complex.n_corners(), n_corners) << "the cut opens nowhere";
    EXPECT_EQ(grid::n_pieces(body.solid.complex), 1u);
    for (const grid::EdgeCut& cut : body.solid.cuts.all())
      EXPECT_TRUE(cut.label == grid::skin_label || !meets_skin(body, cut.edge));
    if (integration == "octants")
      expect_same(before, balance(body), 1e-12);
    else // doubles what a copy shares with another
      EXPECT_GT(balance(body).mass, 1.001 * before.mass);
  }
}

TEST(Recut, ACompleteCutOfAPlaneSkinKeepsEveryBalance) {
  World world = tumbling_world(long_blade(), "octants");
  const Balance before = balance(world.bodies[0]);
  cut_through(world);
  EXPECT_EQ(grid::n_pieces(world.bodies[0].solid.complex), 2u);
  EXPECT_EQ(world.bodies[0].cutter->counts().n_double_crossings, 0u);
  expect_same(before, balance(world.bodies[0]), 1e-12);
}

TEST(Recut, TheStateIsInheritedCornerByCorner) {
  World world = tumbling_world(long_blade(), "octants");
  Body& body = world.bodies[0];
  std::vector<Vec3> x_of_node(body.solid.grid.n_nodes()), v_of_node(body.solid.grid.n_nodes());
  for (const auto c : ids<grid::CornerId>(body.solid.complex.n_corners())) { // uncut: a corner is a node
    x_of_node[body.solid.complex.node[c].value] = body.state.x[c.value];
    v_of_node[body.solid.complex.node[c].value] = body.state.v[c.value];
  }
  cut_through(world);
  ASSERT_EQ(body.state.x.size(), body.solid.complex.n_corners());
  ASSERT_EQ(body.state.v.size(), body.solid.complex.n_corners());
  for (const auto c : ids<grid::CornerId>(body.solid.complex.n_corners())) {
    EXPECT_EQ(body.state.x[c.value], x_of_node[body.solid.complex.node[c].value]);
    EXPECT_EQ(body.state.v[c.value], v_of_node[body.solid.complex.node[c].value]);
  }
}

TEST(Recut, PiecesLetGoOfEachOther) {
  World world = tumbling_world(long_blade(), "octants");
  const Body& body = world.bodies[0];
  cut_through(world);
  const auto piece = piece_of_corners(body.solid.complex);

  Points x = body.state.x, before, after;
  body.physics->model().force(x, before);
  const Eigen::AngleAxisd turn(0.7, Vec3(1, 2, 3).normalized());
  for (std::size_t i = 0; i < x.size(); ++i)
    if (piece[i] == 0)
      x[i] = turn * (1.1 * x[i]) + Vec3(0.3, -0.2, 0.1);
  body.physics->model().force(x, after);
  for (std::size_t i = 0; i < x.size(); ++i)
    if (piece[i] == 1) {
      EXPECT_EQ(before[i], after[i]);
    }
}

/// Cells where cuts cross: a later cut moves vertices of an earlier one, and gives copies material of others, whose
/// corners move otherwise.
TEST(Recut, CutsThatCrossKeepMomentum) {
  const std::string blades = long_blade() + "subsection Blade second\n"
                                            "  set Edge [m]      = 0.03, -0.2, 0; -0.02, 0.2, 0.03\n"
                                            "  set Times [s]     = 0.05, 0.1\n"
                                            "  set Positions [m] = 0, 0.01, 0.14; 0.02, 0, -0.14\n"
                                            "end\n"
                                            "subsection Blade third\n"
                                            "  set Edge [m]      = -0.2, 0.02, 0; 0.2, -0.01, 0.04\n"
                                            "  set Times [s]     = 0.1, 0.15\n"
                                            "  set Positions [m] = 0, 0.02, 0.14; 0, -0.02, -0.14\n"
                                            "end\n";
  for (const std::string physics : {"Integrator=implicit Euler", "Integrator=Newmark", "Backend=lattice",
                                    "Backend=mass-spring"}) {
    SCOPED_TRACE(physics);
    World world = world_of(cube_scene() + blades,
                           {"Time/End time [s]=0.15", "Body cube/Cube edge [m]=0.025", "Body cube/" + physics});
    Body& body = world.bodies[0];
    set_in_motion(body, Vec3(0.5, -2, 1), 1);
    const auto momentum = [&] {
      return Vec3(value(body, "momentum x"), value(body, "momentum y"), value(body, "momentum z"));
    };
    const Vec3 before = momentum();
    const double energy = value(body, "kinetic energy");
    cut_through(world);
    EXPECT_GE(grid::n_pieces(body.solid.complex), 6u);
    EXPECT_LE((momentum() - before).norm(), 1e-12 * before.norm());
    EXPECT_LE(value(body, "kinetic energy"), energy * (1 + 1e-12));
  }
}

TEST(Recut, APieceMovedRigidlyIsWithoutForce) {
  World world = world_of(cube_scene() + long_blade(), {"Body cube/Cube edge [m]=0.025"});
  Body& body = world.bodies[0];
  cut_through(world);
  ASSERT_EQ(grid::n_pieces(body.solid.complex), 2u);
  const auto piece = piece_of_corners(body.solid.complex);
  for (std::size_t i = 0; i < body.state.x.size(); ++i)
    if (piece[i] == 0)
      body.state.x[i] += Vec3(0.05, 0, 0.02);
  Points force;
  body.physics->model().force(body.state.x, force);
  for (const Vec3& f : force)
    EXPECT_LE(f.norm(), 1e-10); // against E h^2 = 6 N
  EXPECT_LE(body.physics->model().energy(body.state.x), 1e-12);
}

TEST(Recut, FrontsThatAreTakenBackKeepMassAndMomentum) {
  World world = tumbling_world(turning_blade(), "octants");
  world.n_steps = 40;
  world.time_step = 0.05 / world.n_steps;
  Body& body = world.bodies[0];
  const Balance before = balance(body);
  cut_through(world);
  const Balance after = balance(body);
  ASSERT_GT(body.solid.complex.lapsed.size(), 0u);
  EXPECT_GT(grid::n_pieces(body.solid.complex), 1u);
  EXPECT_NEAR(after.mass, before.mass, 1e-12 * before.mass);
  EXPECT_NEAR(after.rest_volume, before.rest_volume, 1e-12 * before.rest_volume);
  EXPECT_LE((after.momentum - before.momentum).norm(), 1e-12 * before.momentum.norm());
}

/// Cutting while the run goes on: nothing in the steps between cuts may break what cuts keep.
TEST(Recut, ARunKeepsMomentumAndMassThroughItsCuts) {
  World world = tumbling_world(long_blade(), "octants");
  const Balance before = balance(world.bodies[0]);
  world.bodies[0].state.v.assign(world.bodies[0].state.v.size(), before.momentum / before.mass);
  const output::TemporaryFolder folder;
  run_silently(world, folder / "out");
  const Balance after = balance(world.bodies[0]);
  EXPECT_GT(world.bodies[0].n_recuts, 1);
  EXPECT_NEAR(after.mass, before.mass, 1e-12 * before.mass);
  EXPECT_LE((after.momentum - before.momentum).norm(),
            1e-5 * before.momentum.norm()); // conjugate gradients stop at 1e-6
}

} // namespace
} // namespace kerf::scene::recut_test
