/// Trilinear shape functions against their definition.

#include "grid/shape.h"

#include "tests/support/bodies.h"

#include <gtest/gtest.h>

namespace kerf::grid::shape_test {
namespace {

using support::Random;

TEST(Shape, FunctionsAreOneAtTheirVertexAndSumToOne) {
  Random random(9);
  for (int i = 0; i < 20; ++i) {
    const Vec3 xi = support::random_offset(random);
    double sum = 0;
    Vec3 sum_of_gradients = Vec3::Zero(), place = Vec3::Zero();
    for (int v = 0; v < 8; ++v) {
      const Vec3 vertex(v & 1, v >> 1 & 1, v >> 2 & 1);
      for (int w = 0; w < 8; ++w)
        EXPECT_EQ(shape(w, vertex), v == w ? 1 : 0);
      sum += shape(v, xi);
      place += shape(v, xi) * vertex;
      sum_of_gradients += shape_gradient(v, xi);
      for (int d = 0; d < 3; ++d) { // linear along each axis, so the difference is exact
        Vec3 low = xi, high = xi;
        low[d] = 0;
        high[d] = 1;
        EXPECT_NEAR(shape_gradient(v, xi)[d], shape(v, high) - shape(v, low), 1e-15);
      }
      EXPECT_EQ(shape(v, xi), shape(v, xi, 0xff));
    }
    EXPECT_NEAR(sum, 1, 1e-15);
    EXPECT_LT((place - xi).norm(), 1e-15);
    EXPECT_LT(sum_of_gradients.norm(), 1e-15);
    EXPECT_EQ(shape(1, xi, 0b00000011), xi[0]);
    EXPECT_NEAR(shape(6, xi, 0b01010101), xi[1] * xi[2], 1e-16); // in the face x = 0
  }
}

} // namespace
} // namespace kerf::grid::shape_test
