#include "render/shading.h"

#include "tests/render/shapes.h"

#include <gtest/gtest.h>

#include <array>
#include <set>

namespace kerf::render::shading_test {
namespace {

TEST(Shading, ASphereIsSmooth) {
  const auto mesh = shapes::sphere(0.3, 4);
  const ShadedMesh shaded = shade(mesh.positions, mesh.triangles, mesh.labels);
  EXPECT_EQ(shaded.vertices.size(), mesh.positions.size());
  // Triangles are up to 0.13 radii wide; where small ones meet large ones, the weights tilt the normal by a share.
  for (const ShadedVertex& v : shaded.vertices)
    EXPECT_LT((v.normal - mesh.positions[v.vertex].normalized()).norm(), 0.13 / 5);
}

TEST(Shading, ACubeKeepsItsEdges) {
  const auto mesh = shapes::cube(2);
  const ShadedMesh shaded = shade(mesh.positions, mesh.triangles, {});
  EXPECT_EQ(shaded.vertices.size(), 24u);
  for (const ShadedVertex& v : shaded.vertices)
    EXPECT_NEAR(v.normal.lpNorm<Eigen::Infinity>(), 1, 1e-14);
}

TEST(Shading, ALabelBorderIsSharpOnASmoothSurface) {
  auto mesh = shapes::sphere(1, 3);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    mesh.labels[t] = (mesh.positions[a] + mesh.positions[b] + mesh.positions[c]).x() > 0 ? 3 : 0;
  }
  const ShadedMesh shaded = shade(mesh.positions, mesh.triangles, mesh.labels);
  std::size_t n_on_border = 0;
  for (const Vec3& p : mesh.positions)
    n_on_border += std::abs(p.x()) < 1e-12 ? 1 : 0;
  EXPECT_EQ(n_on_border, 32u);
  EXPECT_EQ(shaded.vertices.size(), mesh.positions.size() + n_on_border);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int i = 0; i < 3; ++i) {
      const ShadedVertex& v = shaded.vertices[shaded.triangles[t][i]];
      EXPECT_EQ(v.vertex, mesh.triangles[t][i]);
      EXPECT_EQ(v.label, mesh.labels[t]);
    }
}

TEST(Shading, CreaseAngleDecides) {
  // Two triangles that meet at the x axis and bend by 40 degrees.
  const double bend = 40 * std::numbers::pi / 180;
  const Points x = {{0, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, std::cos(bend), std::sin(bend)}};
  const std::vector<Triangle> triangles = {{0, 2, 1}, {0, 1, 3}};
  EXPECT_EQ(shade(x, triangles, {}, 41).vertices.size(), 4u);
  EXPECT_EQ(shade(x, triangles, {}, 39).vertices.size(), 6u);
}

TEST(Shading, TwoConesThatTouchInAVertexStayApart) {
  // Both fans meet in vertex 0 and share no edge.
  const Points x = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
  EXPECT_EQ(shade(x, std::vector<Triangle>{{0, 1, 2}, {0, 3, 4}}, {}).vertices.size(), 6u);
}

TEST(Shading, TrianglesWithoutAreaDoNoHarm) {
  const Points x = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.5, 0, 0}};
  const ShadedMesh shaded = shade(x, std::vector<Triangle>{{0, 1, 2}, {0, 3, 1}, {3, 3, 3}}, {});
  for (const ShadedVertex& v : shaded.vertices)
    EXPECT_NEAR(v.normal.z(), 1, 1e-14);
}

} // namespace
} // namespace kerf::render::shading_test
