/// What every constitutive law must do, law by law.

#include "material/laws.h"

#include "base/error.h"

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include <random>

namespace kerf::material::laws_test {
namespace {

using Vector9 = Eigen::Matrix<double, 9, 1>;

const std::vector<Elastic> materials = {{.youngs_modulus = 1, .poissons_ratio = 0},
                                        {.youngs_modulus = 3, .poissons_ratio = 0.3},
                                        {.youngs_modulus = 2, .poissons_ratio = 0.45},
                                        {.youngs_modulus = 1, .poissons_ratio = 0.499},
                                        {.youngs_modulus = 1, .poissons_ratio = -0.4}};

template <class Law>
class Laws : public testing::Test {
 protected:
  static Law make(const Elastic& material) { return {material.lambda(), material.mu()}; }

  double draw(const double lower, const double upper) {
    return std::uniform_real_distribution<double>(lower, upper)(engine_);
  }
  Mat3 any_matrix(const double size) {
    Mat3 A;
    for (int i = 0; i < 9; ++i)
      A(i) = draw(-size, size);
    return A;
  }
  Mat3 rotation() {
    std::normal_distribution<double> normal;
    return Eigen::Quaterniond(normal(engine_), normal(engine_), normal(engine_), normal(engine_))
      .normalized()
      .toRotationMatrix();
  }
  /// A deformation with stretches between `least` and 1.6, the smallest of them negative if asked for.
  Mat3 deformation(const double least, const double sign = 1) {
    const Vec3 s(draw(1.2, 1.6), draw(0.9, 1.1), sign * draw(least, 0.8));
    return rotation() * s.asDiagonal() * rotation();
  }
  /// Ordinary and inverted ones.
  std::vector<Mat3> deformations() {
    std::vector<Mat3> all;
    for (int n = 0; n < 12; ++n) {
      all.push_back(deformation(0.3));
      all.push_back(deformation(0.2, -1));
      all.push_back(Mat3::Identity() + any_matrix(0.1));
    }
    return all;
  }

 private:
  std::mt19937 engine_{17};
};

using AllLaws = testing::Types<SmallStrain, Corotational, StVenantKirchhoff, NeoHookean>;
TYPED_TEST_SUITE(Laws, AllLaws);

/// Size of stresses and tangents to measure errors by.
double scale(const Elastic& material) { return std::abs(material.lambda()) + 2 * material.mu(); }

/// Central differences of fourth order.
template <class Function>
auto derivative(const Function& f, const double step) {
  return ((8 * (f(step) - f(-step)) - (f(2 * step) - f(-2 * step))) / (12 * step)).eval();
}

TYPED_TEST(Laws, StressIsTheDerivativeOfTheEnergy) {
  for (const Elastic& material : materials) {
    const auto law = this->make(material);
    for (const Mat3& F : this->deformations()) {
      const Mat3 P = law.stress(F), d = this->any_matrix(1);
      const auto energy = [&](const double t) { return Eigen::Matrix<double, 1, 1>(law.energy(F + t * d)); };
      EXPECT_NEAR(derivative(energy, 3e-4)(0), P.cwiseProduct(d).sum(), 1e-8 * scale(material)) << F;
    }
  }
}

TYPED_TEST(Laws, TangentIsTheDerivativeOfTheStressAndSymmetric) {
  for (const Elastic& material : materials) {
    const auto law = this->make(material);
    for (const Mat3& F : this->deformations()) {
      const Tangent A = law.tangent(F);
      EXPECT_LT((A - A.transpose()).norm(), 1e-14 * A.norm());
      const Mat3 d = this->any_matrix(1);
      const Mat3 difference = derivative([&](const double t) { return Mat3(law.stress(F + t * d)); }, 3e-4);
      const Vector9 product = A * Eigen::Map<const Vector9>(d.data());
      EXPECT_LT((product - Eigen::Map<const Vector9>(difference.data())).norm(), 2e-7 * (scale(material) + A.norm()))
        << F;
    }
  }
}

TYPED_TEST(Laws, RestHasNeitherEnergyNorStress) {
  for (const Elastic& material : materials) {
    const auto law = this->make(material);
    EXPECT_NEAR(law.energy(Mat3::Identity()), 0, 1e-15 * scale(material));
    EXPECT_LT(law.stress(Mat3::Identity()).norm(), 1e-14 * scale(material));
  }
}

/// For small strain of any direction all laws are Hooke's: energy, stress, and the tangent at rest.
TYPED_TEST(Laws, SmallStrainIsHookes) {
  for (const Elastic& material : materials) {
    const auto law = this->make(material);
    const Tangent hooke = SmallStrain{material.lambda(), material.mu()}.tangent(Mat3::Identity());
    EXPECT_LT((law.tangent(Mat3::Identity()) - hooke).norm(), 1e-13 * hooke.norm());
    const Mat3 strain = 0.5e-6 * (Mat3::Identity() + this->any_matrix(1));
    const Mat3 e = strain + strain.transpose();
    const Mat3 sigma = material.lambda() * e.trace() * Mat3::Identity() + 2 * material.mu() * e;
    EXPECT_LT((law.stress(Mat3::Identity() + e) - sigma).norm(), 1e-5 * sigma.norm());
    EXPECT_NEAR(law.energy(Mat3::Identity() + e), 0.5 * sigma.cwiseProduct(e).sum(), 1e-15 * scale(material));
  }
}

/// A bar pulled by a little narrows by Poisson's ratio and needs Young's modulus.
TYPED_TEST(Laws, PullABarByYoungAndPoisson) {
  for (const Elastic& material : materials) {
    const double pull = 1e-7;
    const Mat3 F = Vec3(1 + pull, 1 - material.poissons_ratio * pull, 1 - material.poissons_ratio * pull).asDiagonal();
    const Mat3 P = this->make(material).stress(F);
    EXPECT_NEAR(P(0, 0) / (material.youngs_modulus * pull), 1, 1e-4);
    EXPECT_LT(std::abs(P(1, 1)) + std::abs(P(2, 2)), 1e-4 * material.youngs_modulus * pull);
  }
}

/// psi(Q F) = psi(F), P(Q F) = Q P(F); the small-strain law alone does not turn with the frame.
TYPED_TEST(Laws, TurnWithTheFrame) {
  for (const Elastic& material : materials) {
    const auto law = this->make(material);
    for (const Mat3& F : this->deformations()) {
      const Mat3 Q = this->rotation();
      const double size = scale(material);
      if constexpr (std::is_same_v<TypeParam, SmallStrain>) {
        EXPECT_GT((law.stress(Q * F) - Q * law.stress(F)).norm(), 1e-3 * size);
      } else {
        EXPECT_NEAR(law.energy(Q * F), law.energy(F), 1e-13 * size);
        EXPECT_LT((law.stress(Q * F) - Q * law.stress(F)).norm(), 1e-12 * size);
      }
    }
  }
}

/// psi(Q^T F Q) = psi(F): no direction of the material is special. Those that turn with the frame have psi(F Q) too.
TYPED_TEST(Laws, AreIsotropic) {
  for (const Elastic& material : materials) {
    const auto law = this->make(material);
    for (const Mat3& F : this->deformations()) {
      const Mat3 Q = this->rotation();
      EXPECT_NEAR(law.energy(Q.transpose() * F * Q), law.energy(F), 1e-13 * scale(material));
      EXPECT_LT((law.stress(Q.transpose() * F * Q) - Q.transpose() * law.stress(F) * Q).norm(),
                1e-12 * scale(material));
      if constexpr (!std::is_same_v<TypeParam, SmallStrain>) {
        EXPECT_LT((law.stress(F * Q) - law.stress(F) * Q).norm(), 1e-12 * scale(material));
      }
    }
  }
}

/// No torque: P F^T is symmetric.
TYPED_TEST(Laws, KirchhoffsStressIsSymmetric) {
  if constexpr (!std::is_same_v<TypeParam, SmallStrain>)
    for (const Elastic& material : materials)
      for (const Mat3& F : this->deformations()) {
        const Mat3 tau = this->make(material).stress(F) * F.transpose();
        EXPECT_LT((tau - tau.transpose()).norm(), 1e-13 * scale(material));
      }
}

std::vector<Mat3> hard_cases() {
  std::vector<Mat3> all;
  for (int n = 0; n < 19683; n += 7) { // matrices of -1, 0 and 1
    Mat3 F;
    for (int i = 0, code = n; i < 9; ++i, code /= 3)
      F(i) = code % 3 - 1;
    all.push_back(F);
  }
  for (const double size : {1e-300, 1e-150, 1e-20, 1e-8, 1e3, 1e6})
    for (const Vec3& s : {Vec3(1, 1, 1), Vec3(1, 1, -1), Vec3(1, 0.5, 0), Vec3(1, 0, 0), Vec3(1, 0.7, -0.7)})
      all.push_back(size * s.asDiagonal().toDenseMatrix());
  all.push_back(Mat3::Zero());
  return all;
}

/// Inverted, flat, of no size, huge: energy, stress and both tangents are numbers.
TYPED_TEST(Laws, AreFiniteEverywhere) {
  const auto law = this->make(materials[1]);
  for (const Mat3& F : hard_cases()) {
    EXPECT_TRUE(std::isfinite(law.energy(F))) << F;
    EXPECT_TRUE(law.stress(F).allFinite()) << F;
    EXPECT_TRUE(law.tangent(F).allFinite()) << F;
    EXPECT_TRUE(law.positive_tangent(F).allFinite()) << F;
  }
}

TYPED_TEST(Laws, PositiveTangentHasTheAbsoluteEigenvalues) {
  for (const Elastic& material : {materials[1], materials[3]}) {
    const auto law = this->make(material);
    auto all = this->deformations();
    for (const Mat3& F : {Mat3(Mat3::Zero()), Mat3(-0.5 * Mat3::Identity()), Mat3(0.3 * Mat3::Identity())})
      all.push_back(F);
    for (const Mat3& F : all) {
      const Tangent A = law.tangent(F), positive = law.positive_tangent(F);
      const Eigen::SelfAdjointEigenSolver<Tangent> solver(A);
      const Tangent expected =
        solver.eigenvectors() * solver.eigenvalues().cwiseAbs().asDiagonal() * solver.eigenvectors().transpose();
      EXPECT_LT((positive - expected).norm(), 1e-12 * (A.norm() + scale(material))) << F;
    }
  }
}

/// Where nothing is compressed much, it is the tangent itself.
TYPED_TEST(Laws, PositiveTangentIsExactNearRest) {
  const auto law = this->make(materials[1]);
  const Mat3 F = this->rotation() * Vec3(1.02, 1.01, 1.005).asDiagonal() * this->rotation();
  EXPECT_LT((law.tangent(F) - law.positive_tangent(F)).norm(), 1e-13 * scale(materials[1]));
}

TEST(StretchesOf, AreASingularValueDecompositionByRotations) {
  for (const Mat3& F : hard_cases()) {
    const Stretches s = stretches_of(F);
    const double size = F.norm();
    EXPECT_LT((s.U * s.s.asDiagonal() * s.V.transpose() - F).norm(), 1e-13 * size + 1e-300);
    EXPECT_NEAR(s.U.determinant(), 1, 1e-13);
    EXPECT_NEAR(s.V.determinant(), 1, 1e-13);
    EXPECT_GE(s.s[0], s.s[1]);
    EXPECT_GE(s.s[1], std::abs(s.s[2]) - 1e-13 * size);
  }
}

/// Both wells of a mirrored state would be equal if the energy did not see the sign of det F.
TEST(NeoHookeanLaw, PushesBackFromInversionAndFlatness) {
  const NeoHookean law{1.5, 1};
  for (double s = -2; s < 0.99; s += 0.05) {
    const Mat3 F = Vec3(1, 1, s).asDiagonal();
    EXPECT_LT(law.stress(F)(2, 2), 0) << s;
  }
}

/// Smith, de Goes and Kim 2018, equation 14, written out with their own moduli.
TEST(NeoHookeanLaw, IsThePublishedEnergy) {
  const double lambda = 1.2, mu = 0.7, m = 4 * mu / 3, l = lambda + 5 * mu / 6, a = 1 + m / l - m / (4 * l);
  const auto psi = [&](const Mat3& F) {
    const double I = F.squaredNorm(), J = F.determinant();
    return m / 2 * (I - 3) + l / 2 * (J - a) * (J - a) - m / 2 * std::log(I + 1);
  };
  Mat3 F;
  F << 1.1, 0.3, -0.2, 0.1, 0.8, 0.4, -0.5, 0.2, 1.3;
  EXPECT_NEAR((NeoHookean{lambda, mu}.energy(F)), psi(F) - psi(Mat3::Identity()), 1e-14);
}

TEST(LawOf, KnowsEveryNameAndRefusesOthers) {
  Elastic material{.youngs_modulus = 2, .poissons_ratio = 0.25};
  EXPECT_TRUE(std::holds_alternative<Corotational>(law_of(material)));
  for (const char* name : {"small strain", "corotational", "St. Venant-Kirchhoff", "neo-Hookean"}) {
    material.law = name;
    const Mat3 F = Vec3(1 + 1e-8, 1, 1).asDiagonal();
    const Mat3 P = std::visit([&](const auto& law) { return Mat3(law.stress(F)); }, law_of(material));
    EXPECT_NEAR(P(0, 0), 1e-8 * (material.lambda() + 2 * material.mu()), 1e-14) << name;
  }
  material.law = "rubber";
  EXPECT_THROW(law_of(material), ParameterError);
}

/// Under a large rotation and a small strain the Cauchy stress is Hooke's, turned.
TEST(CauchyStress, TurnsWithTheMaterial) {
  const Mat3 Q = Eigen::AngleAxisd(1.1, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  const Mat3 e = 1e-7 * (Mat3() << 1, 2, 0, 2, -1, 3, 0, 3, 2).finished();
  for (const AnyLaw& law : {AnyLaw(Corotational{2, 1}), AnyLaw(StVenantKirchhoff{2, 1}), AnyLaw(NeoHookean{2, 1})}) {
    const Mat3 expected = Q * (2 * e.trace() * Mat3::Identity() + 2 * e) * Q.transpose();
    EXPECT_LT((cauchy_stress(law, Q * (Mat3::Identity() + e)) - expected).norm(), 1e-5 * expected.norm());
    EXPECT_TRUE(cauchy_stress(law, Mat3::Zero()).allFinite());
  }
}

/// Force over current area: a bar stretched to twice its length carries P over its narrowed section.
TEST(CauchyStress, IsForceOverCurrentArea) {
  const NeoHookean law{2, 1};
  const Mat3 F = Vec3(2, 0.8, 0.7).asDiagonal();
  EXPECT_NEAR(cauchy_stress(law, F)(0, 0), law.stress(F)(0, 0) / (0.8 * 0.7), 1e-14);
}

} // namespace
} // namespace kerf::material::laws_test
