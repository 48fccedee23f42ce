#include "render/rod.h"

#include "tests/render/shapes.h"

#include <gtest/gtest.h>

namespace kerf::render::rod_test {
namespace {

TEST(Rod, IsAClosedTube) {
  const ToolMesh mesh = rod_mesh({{1, 2, 3}, {1, 2, 3}, {1, 2.5, 3}, {1, 4, 3}}, 0.1);
  EXPECT_TRUE(shapes::closed(mesh.triangles));
  EXPECT_EQ(mesh.labels.size(), mesh.triangles.size());
  const double polygon = 16 * std::sin(std::numbers::pi / 8) / 2 * 0.1 * 0.1;
  EXPECT_NEAR(shapes::six_volumes(mesh.positions, mesh.triangles) / 6, 2 * polygon, 1e-12);
}

TEST(Rod, FollowsACurveWithoutATwist) {
  Points path;
  for (int i = 0; i <= 60; ++i)
    path.emplace_back(std::cos(0.1 * i), std::sin(0.1 * i), 0.05 * i);
  const ToolMesh mesh = rod_mesh(path, 0.05);
  EXPECT_TRUE(shapes::closed(mesh.triangles));
  EXPECT_GT(shapes::six_volumes(mesh.positions, mesh.triangles), 0);
  const std::size_t n_around = mesh.positions.size() / path.size();
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    EXPECT_NEAR((mesh.positions[v] - path[v / n_around]).norm(), 0.05, 1e-12);
    if (v >= n_around) { // vertices of a line along the tube stay beside each other
      EXPECT_LT((mesh.positions[v] - mesh.positions[v - n_around]).norm(), 1.2 * 0.112);
    }
  }
}

TEST(Rod, WithoutExtentIsEmpty) {
  EXPECT_TRUE(rod_mesh({}, 1).triangles.empty());
  EXPECT_TRUE(rod_mesh({{1, 2, 3}, {1, 2, 3}}, 1).triangles.empty());
  EXPECT_TRUE(rod_mesh({{0, 0, 0}, {1, 0, 0}}, 0).triangles.empty());
}

TEST(Rod, ThatTurnsBackHasFiniteVertices) {
  for (const Vec3& p : rod_mesh({{0, 0, 0}, {1, 0, 0}, {0, 0, 0}}, 0.1).positions)
    EXPECT_TRUE(p.allFinite());
}

} // namespace
} // namespace kerf::render::rod_test
