#include "material/elastic.h"

#include <gtest/gtest.h>

#include <set>

namespace kerf::material::elastic_test {
namespace {

/// Stress of a small strain by Hooke's law with Lame's parameters.
Mat3 stress(const Elastic& material, const Mat3& strain) {
  return material.lambda() * strain.trace() * Mat3::Identity() + 2 * material.mu() * strain;
}

TEST(Elastic, LamesParametersPullABarByYoungAndPoisson) {
  for (const double E : {1.0, 5e4, 2e11})
    for (const double nu : {-0.5, 0.0, 0.3, 0.4999}) {
      const Elastic material{.youngs_modulus = E, .poissons_ratio = nu};
      const Mat3 strain = Vec3(1, -nu, -nu).asDiagonal();
      const Mat3 expected = Vec3(E, 0, 0).asDiagonal();
      EXPECT_LT((stress(material, strain) - expected).norm(), 1e-11 * E) << E << ' ' << nu;
    }
}

TEST(Elastic, LamesParametersShearByG) {
  const Elastic material{.youngs_modulus = 2.6, .poissons_ratio = 0.3};
  Mat3 strain = Mat3::Zero();
  strain(0, 1) = strain(1, 0) = 0.5;
  EXPECT_NEAR(stress(material, strain)(0, 1), 1, 1e-15);
}

TEST(Elastic, RefusesWhatIsNoSolid) {
  Elastic material;
  Parameters parameters;
  material.describe(parameters);
  ASSERT_EQ(parameters.list().size(), 4u);
  const auto accepts = [&](const std::size_t i, const std::string& value) {
    return parameters.list()[i].check(value).empty();
  };
  EXPECT_FALSE(accepts(0, "0"));
  EXPECT_FALSE(accepts(1, "-1"));
  EXPECT_FALSE(accepts(2, "0.5"));
  EXPECT_FALSE(accepts(2, "-1"));
  EXPECT_TRUE(accepts(2, "0.499"));
  EXPECT_TRUE(accepts(1, "5e4"));
  EXPECT_FALSE(accepts(3, "Mooney-Rivlin"));
  EXPECT_TRUE(accepts(3, "neo-Hookean"));
}

} // namespace
} // namespace kerf::material::elastic_test
