// What supports hold after a cut.

#include "scene/held.h"
#include "tests/scene/worlds.h"

#include <gtest/gtest.h>

namespace kerf::scene {
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
  const auto pieces = physics::corner_pieces(body.solid.complex);
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

TEST(Held, PhyxelsAreHeldWhereTheyRest) {
  const World world = cut_cube("pba");
  const Body& body = world.bodies[0];
  for (const auto phyxel : particles_in(body, above))
    EXPECT_TRUE(above.contains(body.physics->rest()[phyxel]));
}

} // namespace
} // namespace kerf::scene
