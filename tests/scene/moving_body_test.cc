// A body that moves while a blade passes: however fast either moves, the body is parted along the surface of their
// relative motion without a gap.

#include "grid/cube.h"
#include "tests/scene/worlds.h"

#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

namespace kerf::scene::moving_body_test {
namespace {

constexpr double duration = 0.1;     // [s]
constexpr int n_steps = 10;          // a step's relative motion is more than a cube
constexpr double distance = 0.7;     // of relative motion [m]; the diagonal of the cube is 0.35
const Vec3 middle(0.003, 0, 0.0021); // where in the cube the blade is halfway [m]; no node lies on its plane

/// A blade along y that moves by `velocity` [m/s] and is at the world's origin at half of the duration.
std::string blade_text(const Vec3& velocity) {
  const Vec3 reach = 0.5 * duration * velocity;
  std::ostringstream text;
  text.precision(17);
  text << "subsection Blade knife\n  set Edge [m] = 0, -0.3, 0; 0, 0.3, 0\n  set Times [s] = 0, " << duration
       << "\n  set Positions [m] = " << -reach[0] << ", 0, " << -reach[2] << "; " << reach[0] << ", 0, " << reach[2]
       << "\nend\n";
  return text.str();
}

/// Where a body stands that moves rigidly through the world's origin.
struct Motion {
  Vec3 velocity; ///< [m/s]
  Vec3 spin;     ///< rotation vector a second [rad/s]

  void place(Body& body, const double time) const {
    const double t = time - 0.5 * duration;
    const double angle = t * spin.norm();
    const Eigen::AngleAxisd turn(angle, spin.norm() > 0 ? Vec3(spin.normalized()) : Vec3::UnitX());
    for (const auto c : ids<grid::CornerId>(body.solid.complex.n_corners()))
      body.state.x[c.value] = t * velocity + turn * (body.solid.grid.position(body.solid.complex.node[c]) - middle);
  }
};

/// Moves body and blade past each other, and lets the last cuts through.
void pass(World& world, const Motion& motion) {
  Body& body = world.bodies.at(0);
  Timings timings;
  motion.place(body, 0);
  body.cutter->stand(body.state.x);
  for (int step = 1; step <= n_steps || body.cutter->n_waiting() > 0; ++step) {
    const double t0 = (step - 1) * duration / n_steps, t1 = step * duration / n_steps;
    if (step <= n_steps)
      motion.place(body, t1);
    recut(body, world.blades, t0, t1, timings);
  }
}

/// What the body's own relative motion to the blade makes of a node.
bool is_above(const Vec3& node, const Vec3& relative_velocity) {
  return (node - middle).dot(relative_velocity.cross(Vec3::UnitY())) > 0;
}

/// Edges that are cut where they should not be, or the other way round.
std::size_t n_wrong(const Body& body, const Vec3& relative_velocity) {
  std::size_t n = 0;
  for (const auto e : ids<grid::EdgeId>(body.solid.grid.n_edges())) {
    const auto& [a, b] = body.solid.grid.ends(e);
    if (body.solid.grid.is_material(a) && body.solid.grid.is_material(b))
      n += body.solid.cuts.is_cut(e) != (is_above(body.solid.grid.position(a), relative_velocity) !=
                                         is_above(body.solid.grid.position(b), relative_velocity));
  }
  return n;
}

World passing_world(const Vec3& blade_velocity) {
  return world_of(cube_scene() + blade_text(blade_velocity), {"Body cube/Cube edge [m]=0.025"});
}

/// The part of the relative motion that is the blade's own: all, half, little, none, backwards, more than all.
const std::vector<double> blade_shares = {1, 0.5, 0.05, 0, -0.5, 3};

TEST(MovingBody, IsPartedAlongTheRelativeMotion) {
  for (const double angle : {0.0, 0.5, 1.1})
    for (const double share : blade_shares) {
      SCOPED_TRACE("angle " + std::to_string(angle) + ", the blade's share " + std::to_string(share));
      const Vec3 relative = distance / duration * Vec3(std::sin(angle), 0, -std::cos(angle)); // of the blade
      World world = passing_world(share * relative);
      pass(world, {(share - 1) * relative, Vec3::Zero()});
      EXPECT_EQ(n_wrong(world.bodies[0], relative), 0u);
      EXPECT_EQ(grid::n_pieces(world.bodies[0].solid.complex), 2u);
    }
}

TEST(MovingBody, IsPartedWhileItTurns) {
  for (const double turn : {0.2, -0.7, 1.5})
    for (const double share : blade_shares) {
      SCOPED_TRACE("turn " + std::to_string(turn) + ", the blade's share " + std::to_string(share));
      const Vec3 relative = distance / duration * Vec3(0, 0, -1);
      World world = passing_world(share * relative);
      pass(world, {(share - 1) * relative, turn / duration * Vec3::UnitY()});
      EXPECT_EQ(grid::n_pieces(world.bodies[0].solid.complex), 2u);
    }
}

/// Faces in the body of which a sweep has cut an odd number of edges: it would have to end there.
std::size_t n_torn_faces(const Body& body) {
  std::set<grid::FaceId> torn;
  for (const auto c : ids<grid::CellId>(body.solid.grid.n_cells()))
    for (int face = 0; face < grid::cube::n_faces; ++face) {
      int n_cut = 0, n_material = 0;
      for (const int line : grid::cube::face_lines[face])
        n_cut += body.solid.cuts.is_cut(body.solid.grid.edges(c)[line]) ? 1 : 0;
      for (const int vertex : grid::cube::face_vertices[face])
        n_material += body.solid.grid.is_material(body.solid.grid.nodes(c)[vertex]) ? 1 : 0;
      if (n_material == 4 && n_cut % 2 == 1)
        torn.insert(body.solid.grid.faces(c)[face]);
    }
  return torn.size();
}

/// Every node wanders by itself while the blade passes. However it does, the blade has passed it on one side or the
/// other, and an edge is cut when its ends were passed on different sides: round every face that is an even number.
TEST(MovingBody, IsPartedWithoutATearWhileItQuivers) {
  for (const double deviation : {0.05, 0.15, 0.25}) // of a cube's edge, in every step
    for (const unsigned seed : {1u, 2u, 3u, 4u}) {
      SCOPED_TRACE("deviation " + std::to_string(deviation) + ", seed " + std::to_string(seed));
      World world = passing_world(distance / duration * Vec3(0, 0, -1));
      Body& body = world.bodies.at(0);
      Timings timings;
      const std::size_t n_nodes = body.solid.grid.n_nodes();
      for (int step = 1; step <= n_steps || body.cutter->n_waiting() > 0; ++step) {
        const Points offsets = random_points(n_nodes, deviation * body.solid.grid.h(), 100 * seed + step);
        for (const auto c : ids<grid::CornerId>(body.solid.complex.n_corners())) {
          const grid::NodeId node = body.solid.complex.node[c];
          body.state.x[c.value] = body.solid.grid.position(node) + offsets[node.value];
        }
        recut(body, world.blades, (step - 1) * duration / n_steps, step * duration / n_steps, timings);
      }
      EXPECT_EQ(n_torn_faces(body), 0u);
      EXPECT_GE(grid::n_pieces(body.solid.complex), 2u);
    }
}

/// The whole flow: held at its top, the cube is driven down through a blade that rests.
TEST(MovingBody, IsDrivenThroughARestingBlade) {
  World world =
    world_of(cube_scene() +
               "subsection Blade knife\n  set Edge [m] = 0.003, -0.3, -0.15; 0.003, 0.3, -0.15\n"
               "  set Times [s] = 0\n  set Positions [m] = 0, 0, 0\nend\n",
             {"Time/Time step [s]=0.01", "Time/End time [s]=0.5", "Body cube/Support all/Lower [m]=-1,-1,-1",
              "Body cube/Support all/Upper [m]=1,1,1", "Body cube/Support all/Displacement [m]=0;0;-0.8*t"});
  const output::TemporaryFolder folder;
  run_silently(world, folder / "out");
  EXPECT_EQ(grid::n_pieces(world.bodies[0].solid.complex), 2u);
  EXPECT_EQ(n_wrong(world.bodies[0], Vec3::UnitZ()), 0u); // the plane x = 0.003, as `middle` has it
}

/// The same without a hand that drives: it falls.
TEST(MovingBody, FallsThroughARestingBlade) {
  World world = world_of(cube_scene() +
                           "subsection Gravity\nend\nsubsection Blade knife\n"
                           "  set Edge [m] = 0.003, -0.3, -0.15; 0.003, 0.3, -0.15\n"
                           "  set Times [s] = 0\n  set Positions [m] = 0, 0, 0\nend\n",
                         {"Time/Time step [s]=0.01", "Time/End time [s]=0.4"});
  const output::TemporaryFolder folder;
  run_silently(world, folder / "out");
  EXPECT_EQ(grid::n_pieces(world.bodies[0].solid.complex), 2u);
  EXPECT_EQ(n_wrong(world.bodies[0], Vec3::UnitZ()), 0u);
}

/// The whole flow, of a body that flies and a blade that crosses its way: in steps of any length, and whatever moves
/// it, the body is cut where it and the blade are at the same time.
TEST(MovingBody, IsCutWhereItIsThen) {
  const output::TemporaryFolder folder;
  const Vec3 flight(5, 0, 0), stroke(0, 0, -7); // [m/s]; as far as the cube is wide in .04 s
  const double end = 0.06;
  const Vec3 begin = middle + 0.5 * end * (flight - stroke), then = begin + end * stroke;
  std::ostringstream knife;
  knife.precision(17);
  knife << "subsection Blade knife\n set Edge [m] = 0, -0.3, 0; 0, 0.3, 0\n set Times [s] = 0, " << end
        << "\n set Positions [m] = " << begin[0] << ", 0, " << begin[2] << "; " << then[0] << ", 0, " << then[2]
        << "\nend\n";
  for (const std::string backend : {"fem", "mass-spring", "lattice", "pba"})
    for (const double dt : {0.01, 0.002}) {
      SCOPED_TRACE(backend + ", step " + std::to_string(dt));
      World world = world_of(cube_scene() + knife.str(),
                             {"Time/Time step [s]=" + std::to_string(dt), "Time/End time [s]=0.06",
                              "Body cube/Backend=" + backend, "Body cube/Initial state/Velocity [m/s]=5; 0; 0"});
      run_silently(world, folder / ("run" + backend + std::to_string(dt)));
      const Body& body = world.bodies[0];
      EXPECT_EQ(body.pieces.n_pieces, 2u);
      const Vec3 normal = (stroke - flight).cross(Vec3::UnitY()).normalized();
      double farthest = 0;
      for (std::size_t i = 0; i < body.surface.triangles.size(); ++i)
        if (body.surface.labels[i] == 1)
          for (const auto v : body.surface.triangles[i])
            farthest = std::max(farthest, std::abs((body.surface.rest[v] - middle).dot(normal)));
      EXPECT_LT(farthest, 1e-6 * body.solid.grid.h());
    }
}

/// The pieces of all nodes on one side, beyond `distance` [m] from the middle.
std::set<std::uint32_t> pieces_beside(const Body& body, const double distance) {
  const grid::Pieces all = grid::pieces(body.solid.complex);
  std::set<std::uint32_t> pieces;
  for (const auto c : ids<grid::CopyId>(body.solid.complex.n_copies())) {
    const double x = grid::centre(body.solid.grid, body.solid.complex.copies[c].cell)[0];
    if (distance > 0 ? x > distance : x < distance)
      pieces.insert(all.piece[c]);
  }
  return pieces;
}

/// Held at its top and shaken across the blade that sinks through it, the body swings and cuts itself along a wave.
TEST(MovingBody, IsPartedWhileItIsShaken) {
  World world = world_of(
    cube_scene() + falling_blade(),
    {"Blade knife/Times [s]=0, 0.3", "Time/Time step [s]=0.005", "Time/End time [s]=0.35",
     "Body cube/Cube edge [m]=0.025", "Body cube/Support top/Lower [m]=-1,-1,0.08",
     "Body cube/Support top/Upper [m]=1,1,1", "Body cube/Support top/Displacement [m]=0.02*sin(2*pi*12*t); 0; 0"});
  const output::TemporaryFolder folder;
  run_silently(world, folder / "out");
  const Body& body = world.bodies[0];
  std::vector<std::uint32_t> on_both_sides;
  std::ranges::set_intersection(pieces_beside(body, -0.06), pieces_beside(body, 0.06),
                                std::back_inserter(on_both_sides));
  EXPECT_TRUE(on_both_sides.empty());
  EXPECT_GE(grid::n_pieces(body.solid.complex), 2u);
}

/// Held at both ends, carried along, and cut by a blade that goes with it: its copies swing apart while it is cut, and
/// have points of the skin in two places.
TEST(MovingBody, IsPartedBetweenSupportsThatCarryIt) {
  const output::TemporaryFolder folder;
  std::mt19937 random(17);
  const auto uniform = [&](const double from, const double to) {
    return std::uniform_real_distribution<double>(from, to)(random);
  };
  const auto check = [&](const std::string& backend, const std::string& integrator, const double dt,
                         const double velocity, const double at) {
    std::ostringstream text;
    const std::string move = "  set Displacement [m] = " + std::to_string(velocity) + "*t; 0; 0\n end\n";
    text << "subsection Time\n set Time step [s] = " << dt << "\n set End time [s] = 0.4\nend\n"
         << "subsection Body b\n set Backend = " << backend << "\n set Integrator = " << integrator
         << "\n set Shape = box\n set Sides [m] = 0.5, 0.3, 0.3\n set Cube edge [m] = 0.1\n"
         << " subsection Support a\n  set Lower [m] = -9, -9, -9\n  set Upper [m] = -0.09, 9, 9\n"
         << move << " subsection Support b\n  set Lower [m] = 0.13, -9, -9\n  set Upper [m] = 9, 9, 9\n"
         << move << "end\nsubsection Blade k\n set Edge [m] = 0, 0, -1; 0, 0, 1\n set Times [s] = 0, 0.4\n"
         << " set Positions [m] = " << at << ", 0.3, 0; " << at + 0.4 * velocity << ", -0.3, 0\nend\n";
    World world = world_of(text.str());
    run_silently(world, folder / ("run" + std::to_string(random())));
    EXPECT_GE(world.bodies[0].pieces.n_pieces, 2u) << text.str();
  };
  check("fem", "implicit Euler", 0.0025, 1, 0.04); // these three hung together by one segment of the skin
  check("mass-spring", "generalised alpha", 0.002, 1.04, 0.036);
  check("fem", "Newmark", 0.004, 0.39, -0.042);
  for (int i = 0; i < 24; ++i)
    check(i % 2 == 0 ? "fem" : "mass-spring", std::array{"implicit Euler", "Newmark", "BDF2"}[i % 3],
          std::array{0.002, 0.004}[i / 3 % 2], uniform(-1.2, 1.2), uniform(-0.06, 0.06));
}

/// It bounces on a floor while a blade goes straight through it, near points of the skin that lie in the plane of its
/// cut: these go over from copy to copy when what fronts have parted is parted as the blade has, and are met on that
/// way too. Else one half hung from the other by a point that two cuts of the same blade had passed on either side.
TEST(MovingBody, IsPartedWhileItBounces) {
  const output::TemporaryFolder folder;
  std::mt19937 random(23);
  const auto uniform = [&](const double from, const double to) {
    return std::uniform_real_distribution<double>(from, to)(random);
  };
  const auto check = [&](const std::string& backend, const double dt, const double modulus, const double at,
                         const double end) {
    std::ostringstream text;
    text << "subsection Time\n set Time step [s] = " << dt << "\n set End time [s] = 0.36\nend\n"
         << "subsection Gravity\nend\nsubsection Floor f\n set Point [m] = 0, 0, -0.25\n set Friction [1] = "
         << (backend == "lattice" ? 0.3 : 0) << "\nend\n"
         << "subsection Body b\n set Backend = " << backend
         << "\n set Shape = box\n set Sides [m] = 1, 0.6, 0.4\n set Cube edge [m] = 0.05\n subsection Material\n"
         << "  set Density [kg/m^3] = 1000\n  set Young's modulus [Pa] = " << modulus
         << "\n  set Poisson's ratio [1] = 0.4\n end\n subsection Damping\n  set Mass damping [1/s] = 1\n end\nend\n"
         << "subsection Blade k\n set Edge [m] = 0, -0.7, 0; 0, 0.7, 0\n set Times [s] = 0.1, 0.36\n"
         << " set Positions [m] = " << at << ", 0, 0.4; " << at << ", 0, " << end << "\nend\n";
    World world = world_of(text.str());
    run_silently(world, folder / ("run" + std::to_string(random())));
    EXPECT_EQ(world.bodies[0].pieces.n_pieces, 2u) << text.str();
  };
  check("lattice", 0.002, 5e5, 0, -0.55); // this one hung together
  for (int i = 0; i < 4; ++i)
    check(i % 2 == 0 ? "lattice" : "mass-spring", 0.002, std::pow(10, uniform(5.3, 6)), i < 2 ? 0 : uniform(-0.1, 0.1),
          uniform(-0.7, -0.45));
}

} // namespace
} // namespace kerf::scene::moving_body_test
