/// Normals at a scale against a plain search: triangles are added until none is near any more.

#include "geometry/normals.h"

#include "tests/geometry/meshes.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <cmath>
#include <random>

namespace kerf::geometry::normals_test {
namespace {

Vec3 area_normal(const TriangleMesh& mesh, const std::size_t i) {
  const auto [a, b, c] = corners(mesh, i);
  return (b - a).cross(c - a);
}

struct Mean {
  Vec3 normal = Vec3::Zero();
  std::size_t n_triangles = 0;
};

Mean plain_mean(const TriangleMesh& mesh, const std::uint32_t triangle, const Vec3& point, const double radius) {
  std::vector<bool> is_in(mesh.triangles.size(), false);
  is_in[triangle] = true;
  const Vec3 own = area_normal(mesh, triangle).normalized();
  const auto shares_near_vertex = [&](const std::size_t i, const std::size_t k) {
    for (const auto v : mesh.triangles[i])
      for (const auto w : mesh.triangles[k])
        if (v == w && (mesh.vertices[v] - point).norm() <= radius)
          return true;
    return false;
  };
  for (bool grows = true; grows;) {
    grows = false;
    for (std::size_t i = 0; i < is_in.size(); ++i)
      for (std::size_t k = 0; k < is_in.size() && !is_in[i]; ++k)
        if (is_in[k] && area_normal(mesh, i).normalized().dot(own) > std::sqrt(0.5) && shares_near_vertex(i, k))
          is_in[i] = grows = true;
  }
  Mean mean;
  for (std::size_t i = 0; i < is_in.size(); ++i)
    if (is_in[i]) {
      mean.normal += area_normal(mesh, i);
      ++mean.n_triangles;
    }
  mean.normal.normalize();
  return mean;
}

TEST(LocalNormals, AreThoseOfAPlainSearch) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> part(0, 1);
  std::size_t n_alone = 0, n_some = 0, n_many = 0;
  for (const TriangleMesh& mesh : {sphere_mesh(1, {0.1, 0.2, 0.3}, 2), box_mesh({-1, -1, -1}, {1, 2, 0.5})}) {
    const LocalNormals normals(mesh);
    LocalNormals::Marks marks(normals);
    for (int i = 0; i < 300; ++i) {
      const auto triangle = static_cast<std::uint32_t>(random() % mesh.triangles.size());
      const auto [a, b, c] = corners(mesh, triangle);
      const double u = part(random), v = part(random) * (1 - u), radius = (b - a).norm() * 2 * part(random);
      const Vec3 point = a + u * (b - a) + v * (c - a);
      const Mean plain = plain_mean(mesh, triangle, point, radius);
      ASSERT_LT((normals.at(triangle, point, radius, marks) - plain.normal).norm(), 1e-13);
      ++(plain.n_triangles == 1 ? n_alone : plain.n_triangles < 8 ? n_some : n_many);
    }
  }
  EXPECT_GT(n_alone, 50u);
  EXPECT_GT(n_some, 50u);
  EXPECT_GT(n_many, 50u);
}

} // namespace
} // namespace kerf::geometry::normals_test
