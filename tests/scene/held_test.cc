// What supports hold after a cut.

#include "scene/held.h"
#include "tests/scene/worlds.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace kerf::scene::held_test {
namespace {

const HalfSpace above{.point = Vec3(0, 0, 0.06), .normal = -Vec3::UnitZ()};

/// The cube with its upper layer of nodes cut off: the piece below has corners above the cut, and nothing else there.
World cut_cube(const std::string& backend) {
  World world = world_of(cube_scene(), {"Body cube/Backend=" + backend, "Cut surface top/Shape=plane",
                                        "Cut surface top/Point [m]=0, 0, 0.055", "Cut surface top/Normal [1]=0, 0, 1"});
  Timings seconds;
  advance(world, 1, seconds);
  return world;
}

TEST(Held, CornersOfPiecesThatHaveNothingThereAreFree) {
  const World world = cut_cube("fem");
  const Body& body = world.bodies[0];
  ASSERT_EQ(grid::n_pieces(body.solid.complex), 2u);
  const auto pieces = grid::corner_pieces(body.solid.complex);
  const auto held = particles_in(body, above);
  std::size_t n_inside = 0;
  for (const Vec3& X : body.physics->rest())
    n_inside += above.contains(X) ? 1 : 0;
  EXPECT_EQ(n_inside, 36u + 36u + 36u); // 6 x 6 at the nodes of both pieces, and above them
  ASSERT_EQ(held.size(), 36u + 36u);
  const auto upper = pieces[held[0]];
  for (const auto corner : held)
    EXPECT_EQ(pieces[corner], upper);
}

/// Corners beyond the skin are held as before where the material before them is.
TEST(Held, CornersBeyondTheSkinAreHeld) {
  const World world = world_of(cube_scene());
  const auto held = particles_in(world.bodies[0], HalfSpace{.point = Vec3(0, 0, 0.08), .normal = -Vec3::UnitZ()});
  EXPECT_EQ(held.size(), 36u); // the nodes' layer is at 0.075, the skin at 0.1, these at 0.125
  EXPECT_TRUE(particles_in(world.bodies[0], HalfSpace{.point = Vec3(0, 0, 0.11), .normal = -Vec3::UnitZ()}).empty());
}

/// Material of a piece that is free has another shape with each cut, and may reach into a region for the first time: a
/// support that took hold of it then would draw it back from wherever it is.
TEST(Held, ACutGivesSupportsNothingThatIsFree) {
  const Vec3 away(0, 0.3, 0), normal = Vec3(3, -1, 2).normalized();
  const Overrides held_below = {"Body cube/Cube edge [m]=0.021",
                                "Body cube/Support s/Region=half space",
                                "Body cube/Support s/Plane point [m]=0, 0, 0",
                                "Body cube/Support s/Plane normal [1]=3, -1, 2",
                                "Cut surface c/Shape=plane",
                                "Cut surface c/Point [m]=0, 0, 0",
                                "Cut surface c/Normal [1]=0, 0, 1"};
  std::size_t n_held = 0, n_let_go = 0;
  for (unsigned seed = 0; seed < 8; ++seed) {
    World world = world_of(cube_scene(), held_below), resumed = world_of(cube_scene(), held_below);
    Body& body = world.bodies[0];
    Timings seconds;
    cut_at_once(body, {"first", cut::Plane{0.0006 * (seed + 1) * normal, normal}, 1}, seconds);
    std::vector<std::uint8_t> is_held(body.state.x.size(), 0);
    const auto pieces = grid::corner_pieces(body.solid.complex);
    for (const auto i : body.loads.supports[0].corners)
      is_held[pieces[i]] = 1; // of a piece
    for (std::size_t i = 0; i < body.state.x.size(); ++i)
      if (!is_held[pieces[i]])
        body.state.x[i] += away;
    follow(body);
    std::mt19937 random(seed);
    std::normal_distribution<double> normally(0, 0.05);
    for (int k = 0; k < 8; ++k) {
      const Vec3 centre = away + Vec3(normally(random), normally(random), normally(random));
      cut_at_once(body, {"ball", cut::Sphere{centre, 0.05 + std::abs(normally(random))}, 1}, seconds);
      const dynamics::Support& support = body.loads.supports[0];
      n_held += support.corners.size();
      for (std::size_t i = 0; i < support.corners.size(); ++i)
        EXPECT_LT((body.state.x[support.corners[i]] - support.rest[i]).norm(), 1e-9)
          << "seed " << seed << ", cut " << k;
    }
    const auto& corners = body.loads.supports[0].corners;
    n_let_go += particles_in(body, body.regions[0].region).size() - corners.size();
    Archive archived;
    archive(archived, body);
    Archive back(archived.bytes(), "a test");
    archive(back, resumed.bodies[0]);
    EXPECT_EQ(resumed.bodies[0].loads.supports[0].corners, corners) << "seed " << seed;
  }
  EXPECT_GT(n_held, 10000u);
  EXPECT_GT(n_let_go, 0u); // which have material in the region now
}

TEST(Held, PhyxelsAreHeldWhereTheyRest) {
  const World world = cut_cube("pba");
  const Body& body = world.bodies[0];
  for (const auto phyxel : particles_in(body, above))
    EXPECT_TRUE(above.contains(body.physics->rest()[phyxel]));
}

} // namespace
} // namespace kerf::scene::held_test
