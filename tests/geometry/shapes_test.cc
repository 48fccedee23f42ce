// Simple bodies: volumes and moments of inertia against closed forms, and what they are as meshes.

#include "geometry/shapes.h"
#include "geometry/solid.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <cmath>
#include <numbers>

namespace kerf::geometry::shapes_test {
namespace {

constexpr double pi = std::numbers::pi;

/// The integral of p p^T over what the mesh encloses [m^5]: of tetrahedra from the origin.
Mat3 second_moments(const TriangleMesh& mesh) {
  Mat3 sum = Mat3::Zero();
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto [a, b, c] = corners(mesh, i);
    const Vec3 s = a + b + c;
    sum += a.dot(b.cross(c)) / 120 * (a * a.transpose() + b * b.transpose() + c * c.transpose() + s * s.transpose());
  }
  return sum;
}

void expect_solid(const TriangleMesh& mesh, const double expected_volume) {
  EXPECT_NEAR(volume(mesh) / expected_volume, 1, 1e-12);
  const TriangleMesh solid = require_solid(mesh, "shape");
  EXPECT_EQ(solid.triangles, mesh.triangles) << "they were counter-clockwise";
}

TEST(Shapes, ABoxIsExact) {
  const TriangleMesh box = box_mesh({-1, -2, -3}, {1, 2, 3});
  expect_solid(box, 48);
  EXPECT_LT((second_moments(box) - 48. / 3 * Vec3(1, 4, 9).asDiagonal().toDenseMatrix()).norm(), 1e-12);
}

/// The volume exactly; moments, and the distance of the skin, with the square of the edge.
TEST(Shapes, ABallHasItsVolume) {
  double before = 1;
  for (const double edge : {0.4, 0.2, 0.1}) {
    const TriangleMesh ball = ball_mesh(Vec3::Zero(), 2, edge);
    expect_solid(ball, 4 * pi / 3 * 8);
    double longest = 0, off = 0;
    for (std::size_t i = 0; i < ball.triangles.size(); ++i) {
      const auto [a, b, c] = corners(ball, i);
      longest = std::max({longest, (a - b).norm(), (b - c).norm(), (c - a).norm()});
      off = std::max({off, std::abs(a.norm() - 2), std::abs((a + b + c).norm() / 3 - 2)});
    }
    EXPECT_LT(longest, edge);
    EXPECT_LT(off, edge * edge / 6 / 2);
    const double error = (second_moments(ball) / (4 * pi / 15 * 32) - Mat3::Identity()).norm();
    EXPECT_LT(error, 0.3 * before);
    before = error;
  }
  EXPECT_LT(before, 1e-4);
}

TEST(Shapes, ACylinderHasItsVolume) {
  constexpr double r = 0.5, h = 3;
  for (const double edge : {1., 0.05, 0.01}) {
    const TriangleMesh cylinder = cylinder_mesh(r, h, edge);
    expect_solid(cylinder, pi * r * r * h);
    const double n = std::max(48., std::ceil(2 * pi * r / edge));
    const Mat3 M = second_moments(cylinder) / (pi * r * r * h);
    EXPECT_NEAR(M(2, 2) / (h * h / 12), 1, 1e-12);
    for (int k = 0; k < 2; ++k) {
      EXPECT_GT(M(k, k) / (r * r / 4), 1 - 1e-12);
      EXPECT_LT(M(k, k) / (r * r / 4), 1 + 3 / (n * n));
    }
  }
}

TEST(Shapes, AreTurnedAndShifted) {
  const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  const TriangleMesh here = box_mesh({-1, -2, -3}, {1, 2, 3}), there = placed(here, turn, {5, 6, 7});
  for (std::size_t i = 0; i < here.vertices.size(); ++i)
    EXPECT_LT((there.vertices[i] - turn * here.vertices[i] - Vec3(5, 6, 7)).norm(), 1e-14);
}

} // namespace
} // namespace kerf::geometry::shapes_test
