/// Elements with strains of their own: what condensing them must keep, and that it is done right.

#include "surface/placement.h"
#include "tests/fem/samples.h"
#include "tests/support/spectrum.h"

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

namespace kerf::fem::enhanced_test {
namespace {

const material::Elastic rubber{.density = 1100, .youngs_modulus = 3e4, .poissons_ratio = 0.42};
const material::Elastic gel{.density = 1000, .youngs_modulus = 1e4, .poissons_ratio = 0.499};

/// Before an element keeps it in single precision.
Matrix24 stiffness(const Moments& moments, const material::Elastic& material, const ElementOptions& options) {
  const Centred positive = centred(without_negative_squares(moments));
  const Matrix24 K = by_nodes(hourglass_stiffness(positive, material, options.strain)) +
                     mean_stiffness(moments[0], mean_gradients(centred(moments)), material);
  return 0.5 * (K + K.transpose());
}

Eigen::Matrix<double, 24, 1> eigenvalues(const Matrix24& K) {
  return support::spectrum(K);
}

/// Gradients of the 12 modes at y from the centroid: of y_j^2 / 2 in direction i, and dilatations along y_j y_k.
std::array<Mat3, 12> mode_gradients(const Vec3& y) {
  std::array<Mat3, 12> all;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      all[3 * i + j] = y[j] * Vec3::Unit(i) * Vec3::Unit(j).transpose();
  for (int j = 0; j < 3; ++j)
    all[9 + j] = y[j] * y[(j + 1) % 3] * Mat3::Identity();
  return all;
}

/// int B^T D B - int B^T D M (int M^T D M)^-1 int M^T D B, with modes less their means.
Matrix24 by_quadrature(const std::vector<WeightedPoint<Vec3>>& rule, const material::Elastic& material) {
  using Modes = Eigen::Matrix<double, 6, 12>;
  double volume = 0;
  Vec3 centroid = Vec3::Zero();
  for (const auto& [x, weight] : rule) {
    volume += weight;
    centroid += weight * x;
  }
  centroid /= volume;
  const auto modes_at = [&](const Vec3& x) {
    Modes M;
    const auto gradients = mode_gradients(x - centroid);
    for (int m = 0; m < 12; ++m)
      M.col(m) = engineering_strain(gradients[m]);
    return M;
  };
  Modes mean = Modes::Zero();
  for (const auto& [x, weight] : rule)
    mean += weight / volume * modes_at(x);
  const auto D = elasticity(material);
  Matrix24 uu = Matrix24::Zero();
  Eigen::Matrix<double, 12, 24> au = Eigen::Matrix<double, 12, 24>::Zero();
  Eigen::Matrix<double, 12, 12> aa = Eigen::Matrix<double, 12, 12>::Zero();
  for (const auto& [x, weight] : rule) {
    const Modes M = modes_at(x) - mean;
    uu += weight * nodal_strains(x).transpose() * D * nodal_strains(x);
    au += weight * M.transpose() * D * nodal_strains(x);
    aa += weight * M.transpose() * D * M;
  }
  return uu - au.transpose() * aa.llt().solve(au);
}

/// Gradients beside the mean have the energy that the stiffness says.
TEST(Enhanced, GradientsHaveTheEnergyOfTheStiffness) {
  auto all = make_samples();
  all.push_back({full_cube_moments(), cube_rule(4)});
  Draw draw(8);
  const auto D = elasticity(rubber);
  for (const Strain strain : {Strain::trilinear, Strain::enhanced})
    for (const Sample& sample : all) {
      const Centred about = centred(without_negative_squares(sample.moments));
      Vector24 u;
      for (int i = 0; i < 24; ++i)
        u[i] = draw.normal();
      const Eigen::Matrix<double, 54, 1> gradients = hourglass_gradients(about, rubber, strain) * u;
      const auto strain_of = [&](const int p) { return engineering_strain(Eigen::Map<const Mat3>(gradients.data() + 9 * p)); };
      double energy = 0;
      for (int p = 0; p < 6; ++p)
        for (int q = 0; q < 6; ++q)
          energy += about.gram(p, q) * strain_of(p).dot(D * strain_of(q));
      const double expected = u.dot(by_nodes(hourglass_stiffness(about, rubber, strain)) * u);
      EXPECT_NEAR(energy, expected, 1e-9 * expected);
    }
}

TEST(Enhanced, AgreesWithQuadratureInItsTetrahedra) {
  double worst = 0;
  auto all = make_samples();
  all.push_back({full_cube_moments(), cube_rule(4)});
  for (const material::Elastic& material : {rubber, gel})
    for (const Sample& sample : all) {
      const Matrix24 K = by_quadrature(sample.rule, material);
      worst =
        std::max(worst, (K - stiffness(sample.moments, material, {.strain = Strain::enhanced})).norm() / K.norm());
    }
  EXPECT_LT(worst, 1e-11);
  RecordProperty("worst", std::to_string(worst * 1e13) + "e-13");
}

TEST(Enhanced, HasSixRigidModesAndIsSofterThanTrilinear) {
  auto all = make_samples();
  all.push_back({full_cube_moments(), {}});
  for (const Sample& sample : all)
    for (const material::Elastic& material : {rubber, gel}) {
      const Matrix24 K = stiffness(sample.moments, material, {.strain = Strain::enhanced});
      EXPECT_EQ((K - K.transpose()).norm(), 0);
      const auto spectrum = eigenvalues(K);
      EXPECT_LT(spectrum.head<6>().cwiseAbs().maxCoeff(), 1e-14 * spectrum[23]);
      EXPECT_GT(spectrum[6], 1e-4 * material.youngs_modulus);
      const Matrix24 trilinear = stiffness(sample.moments, material, {});
      EXPECT_GT(eigenvalues(trilinear - K)[0], -1e-13 * spectrum[23]);
    }
}

/// Near nu = 0.5 only a change of the mean volume is stiff: one mode of an element.
TEST(Enhanced, OnlyTheMeanDilatationIsStiffNearIncompressible) {
  const auto count = [](const Strain strain) {
    const auto spectrum = eigenvalues(stiffness(full_cube_moments(), gel, {.strain = strain}));
    return (spectrum.array() > 10 * gel.youngs_modulus).count();
  };
  EXPECT_EQ(count(Strain::enhanced), 1);
  EXPECT_GE(count(Strain::trilinear), 4);
}

/// The 12 affine displacements of the unit cube's vertices.
Eigen::Matrix<double, 24, 12> affine_displacements() {
  Eigen::Matrix<double, 24, 12> all = Eigen::Matrix<double, 24, 12>::Zero();
  for (int a = 0; a < 8; ++a)
    for (int i = 0; i < 3; ++i) {
      all(3 * a + i, i) = 1;
      for (int j = 0; j < 3; ++j)
        all(3 * a + i, 3 + 3 * i + j) = a >> j & 1;
    }
  return all;
}

/// What makes the patch test hold for every law: an affine displacement feels nothing of the hourglass part.
TEST(Enhanced, LeavesAffineMotionAloneInEveryConfiguration) {
  Draw draw(4);
  const Body block = make_block({2, 2, 2}, 1, draw, {0.3, 0.7});
  const auto cell = *block.grid.find_cell({1, 1, 1});
  const auto affine = affine_displacements();
  double worst = 0;
  for (unsigned configuration = 0; configuration < 4096; ++configuration) {
    Body body = block;
    std::vector<grid::EdgeCut> cuts;
    for (int line = 0; line < 12; ++line)
      if (configuration >> line & 1)
        cuts.push_back({body.grid.edges(cell)[line], draw(0, 1), draw.vector().normalized(), 1});
    body.cut(cuts);
    for (const grid::Copy& copy : body.complex.copies)
      if (copy.cell == cell)
        for (const Strain strain : {Strain::trilinear, Strain::enhanced}) {
          const Matrix24 K = by_nodes(
            hourglass_stiffness(centred(without_negative_squares(material_moments(body, copy))), rubber, strain));
          ASSERT_TRUE(K.allFinite()) << configuration;
          worst = std::max(worst, (K * affine).norm() / rubber.youngs_modulus);
        }
  }
  EXPECT_LT(worst, 1e-13);
}

/// A plane across an axis leaves a cuboid: the element is then that of the cuboid, whose nodes the trilinear field
/// of the cube carries along. So a layer bends the same wherever the grid lies.
TEST(Enhanced, HalfACubeIsACuboid) {
  for (const double t : {0.9, 0.5, 0.1, 1e-3}) {
    Moments moments;
    for (int n = 0; n < 27; ++n)
      moments[n] = std::pow(t, n % 3 + 1) / ((n % 3 + 1) * (n / 3 % 3 + 1) * (n / 9 + 1));
    const Matrix24 K = stiffness(moments, rubber, {.strain = Strain::enhanced});
    // Bending about z: u_x = (x - t/2)(y - 1/2) has the strain e_xx = y - 1/2 and the shear x - t/2, which the modes
    // take away, and e_yy, which they set free in the plane, as they do e_zz in part.
    Vector24 u = Vector24::Zero();
    for (int a = 0; a < 8; ++a)
      u[3 * a] = ((a & 1) - t / 2) * ((a >> 1 & 1) - 0.5);
    const double nu = rubber.poissons_ratio, plane_stress = rubber.youngs_modulus / (1 - nu * nu);
    EXPECT_NEAR(u.dot(K * u) / (plane_stress * t / 12), 1, 1e-9) << t;
  }
}

/// Flat, thin, tiny: matrices stay positive semi-definite and of the material's size.
TEST(Enhanced, SliversAreHarmless) {
  for (const double t : {1e-1, 1e-3, 1e-5, 1e-8})
    for (const Vec3& size : {Vec3(t, 1, 1), Vec3(t, t, 1), Vec3(t, t, t), Vec3(1, t, t * t)})
      for (const material::Elastic& material : {rubber, gel}) {
        Moments moments;
        for (int n = 0; n < 27; ++n)
          moments[n] = std::pow(size[0], n % 3 + 1) * std::pow(size[1], n / 3 % 3 + 1) * std::pow(size[2], n / 9 + 1) /
                       ((n % 3 + 1) * (n / 3 % 3 + 1) * (n / 9 + 1));
        const Matrix24 K = stiffness(moments, material, {.strain = Strain::enhanced});
        ASSERT_TRUE(K.allFinite());
        const auto spectrum = eigenvalues(K), as_kept = eigenvalues(fem::stiffness(
                                                make_element(moments, 1, material, {.strain = Strain::enhanced}), material));
        EXPECT_GT(spectrum[0], -1e-14 * spectrum[23]);
        EXPECT_GT(as_kept[0], -1e-8 * as_kept[23]);
        const Matrix24 trilinear = stiffness(moments, material, {});
        EXPECT_LT(spectrum[23], 1.0001 * eigenvalues(trilinear)[23]);
      }
}

} // namespace
} // namespace kerf::fem::enhanced_test
