#include "render/blade.h"

#include "tests/render/shapes.h"

#include <gtest/gtest.h>

namespace kerf::render::blade_test {
namespace {

TEST(Blade, IsAClosedTaperedPlate) {
  const Vec3 spine(0, 0, 0.02);
  const ToolMesh mesh = blade_mesh({{0, 0, 0}, {0.1, 0, 0}}, spine);
  EXPECT_TRUE(shapes::closed(mesh.triangles));
  // Length x depth x thickness (5 % of the depth), less half of the bevel (22 % of the depth).
  EXPECT_NEAR(shapes::six_volumes(mesh.positions, mesh.triangles) / 6, 0.1 * 0.02 * 0.001 * (1 - 0.22 / 2), 1e-12);
  for (const Vec3& p : mesh.positions)
    EXPECT_LE(std::abs(p.y()), 0.0005 * p.z() / (0.22 * 0.02) + 1e-15);
}

TEST(Blade, FollowsACurvedEdge) {
  Points edge;
  for (int i = 0; i <= 20; ++i)
    edge.emplace_back(std::cos(0.1 * i), std::sin(0.1 * i), 0);
  const ToolMesh mesh = blade_mesh(edge, {0, 0, 0.5});
  EXPECT_TRUE(shapes::closed(mesh.triangles));
  EXPECT_GT(shapes::six_volumes(mesh.positions, mesh.triangles), 0);
  EXPECT_EQ(mesh.labels.size(), mesh.triangles.size());
}

TEST(Blade, WithoutExtentIsEmpty) {
  EXPECT_TRUE(blade_mesh({}, {0, 0, 1}).triangles.empty());
  EXPECT_TRUE(blade_mesh({{1, 2, 3}, {1, 2, 3}}, {0, 0, 1}).triangles.empty());
  EXPECT_TRUE(blade_mesh({{0, 0, 0}, {1, 0, 0}}, {0, 0, 0}).triangles.empty());
}

TEST(Blade, AlongItsSpineHasFiniteVertices) {
  for (const Vec3& p : blade_mesh({{0, 0, 0}, {0, 0, 1}}, {0, 0, 1}).positions)
    EXPECT_TRUE(p.allFinite());
}

} // namespace
} // namespace kerf::render::blade_test
