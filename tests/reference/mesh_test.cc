// Fitted meshes: what they fill, and what a crack doubles.

#include "reference/mesh.h"

#include <gtest/gtest.h>

namespace kerf::reference::mesh_test {
namespace {

const auto everywhere = [](const Vec3&) { return true; };

TEST(Mesh, CoordinatesShrinkTowardsTheirEnd) {
  EXPECT_EQ(graded(0, 8, 3, 0.5), (std::vector<double>{0, 2, 4, 8}));
  EXPECT_EQ(graded_to_both(0, 16, 3, 0.5), (std::vector<double>{0, 2, 4, 8, 12, 14, 16}));
  EXPECT_EQ(equal(1, 2, 2), (std::vector<double>{1, 1.5, 2}));
}

TEST(Mesh, ADiscIsFourQuarters) {
  const Mesh quarter = quarter_disc({1, 2}), whole = disc({1, 2});
  EXPECT_EQ(quarter.cells.size(), 5u);
  EXPECT_EQ(whole.cells.size(), 20u);
  EXPECT_EQ(whole.vertices.size(), 25u) << "the origin, 8 on the core's square, 8 on each circle";
  EXPECT_EQ(extruded(whole, {0, 1, 3}).vertices.size(), 75u);
}

TEST(Mesh, ADiscInASquareIsFourQuartersToo) {
  const Mesh quarter = quarter_disc_in_square({1, 2}, 3), whole = disc_in_square({1, 2}, 3);
  EXPECT_EQ(whole.cells.size(), 4 * quarter.cells.size());
  EXPECT_EQ(whole.vertices.size(), 25u + 8) << "the square's corners and the middles of its sides";
}

/// A crack through all of a block doubles each vertex in it; one that ends inside leaves those of its front.
TEST(Mesh, CracksHaveDoubleVerticesButAtTheirFronts) {
  const Mesh block = extruded(rectangles(equal(0, 4, 4), equal(0, 2, 2)), equal(0, 2, 2));
  Mesh through = block;
  EXPECT_EQ(split(through, Vec3(0, 0, 1), Vec3::UnitZ(), everywhere), 8u);
  EXPECT_EQ(through.vertices.size(), block.vertices.size() + 15);
  Mesh edge = block;
  EXPECT_EQ(split(edge, Vec3(0, 0, 1), Vec3::UnitZ(), [](const Vec3& X) { return X[0] <= 2; }), 4u);
  EXPECT_EQ(edge.vertices.size(), block.vertices.size() + 6);
  Mesh inner = block;
  EXPECT_EQ(split(inner, Vec3(0, 0, 1), Vec3::UnitZ(), [](const Vec3& X) { return X[0] >= 1 && X[0] <= 3; }), 4u);
  EXPECT_EQ(inner.vertices.size(), block.vertices.size() + 3);
}

/// Two cracks that cross part four quarters.
TEST(Mesh, CracksCross) {
  Mesh square = rectangles(equal(-1, 1, 2), equal(-1, 1, 2));
  split(square, Vec3::Zero(), Vec3::UnitX(), everywhere);
  EXPECT_EQ(square.vertices.size(), 12u);
  split(square, Vec3::Zero(), Vec3::UnitY(), everywhere);
  EXPECT_EQ(square.vertices.size(), 16u);
}

/// Faces that lie in the plane only by round-off count; those beside it do not.
TEST(Mesh, OnlyFacesInThePlaneAreParted) {
  Mesh square = rectangles(equal(0, 0.3, 3), equal(0, 1, 1));
  EXPECT_EQ(split(square, Vec3(0.1 + 1e-16, 0, 0), Vec3::UnitX(), everywhere), 1u);
  EXPECT_EQ(split(square, Vec3(0.15, 0, 0), Vec3::UnitX(), everywhere), 0u);
}

} // namespace
} // namespace kerf::reference::mesh_test
