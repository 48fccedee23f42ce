#include "fem/element.h"

#include "tests/fem/samples.h"
#include "tests/support/spectrum.h"

#include <gtest/gtest.h>

namespace kerf::fem::element_test {
namespace {

const material::Elastic rubber{.density = 1100, .youngs_modulus = 3e4, .poissons_ratio = 0.42};

/// int B^T D B, the textbook's way.
Matrix24 by_quadrature(const std::vector<WeightedPoint<Vec3>>& rule, const double h,
                       const material::Elastic& material) {
  const auto D = elasticity(material);
  Matrix24 K = Matrix24::Zero();
  for (const auto& [x, weight] : rule)
    K += h * weight * nodal_strains(x).transpose() * D * nodal_strains(x);
  return K;
}

/// Both parts before they are kept in single precision.
Matrix24 in_double(const Moments& moments, const double h, const Strain strain = Strain::trilinear) {
  const Centred positive = centred(without_negative_squares(moments));
  return h * (by_nodes(hourglass_stiffness(positive, rubber, strain)) +
              mean_stiffness(moments[0], mean_gradients(centred(moments)), rubber));
}

const std::vector<Sample>& samples() {
  static const std::vector<Sample> all = make_samples();
  return all;
}

TEST(Element, FullCubeAgreesWithGaussPoints) {
  const Matrix24 K = by_quadrature(cube_rule(2), 0.3, rubber);
  EXPECT_LT((K - in_double(full_cube_moments(), 0.3)).norm(), 1e-14 * K.norm());
}

TEST(Element, PartialCubeAgreesWithQuadratureInItsTetrahedra) {
  double worst = 0;
  for (const Sample& sample : samples()) {
    const Matrix24 K = by_quadrature(sample.rule, 0.3, rubber);
    worst = std::max(worst, (K - in_double(sample.moments, 0.3)).norm() / K.norm());
  }
  EXPECT_LT(worst, 3e-13);
}

TEST(Element, IsSymmetricAndHasSixRigidModes) {
  std::vector<Sample> all = make_samples();
  all.push_back({full_cube_moments(), {}});
  for (const Sample& sample : all) {
    const Matrix24 K = stiffness(make_element(sample.moments, 0.3, rubber, {}), rubber);
    EXPECT_EQ((K - K.transpose()).norm(), 0);
    const auto eigenvalues = support::spectrum(K);
    EXPECT_LT(eigenvalues.head<6>().cwiseAbs().maxCoeff(), 1e-14 * eigenvalues[23]);
    EXPECT_GT(eigenvalues[6], 1e-6 * eigenvalues[23]);
  }
}

/// Both parts of an element together, for both kinds of strain; the hourglass part in single precision.
TEST(Element, IsItsMeanAndItsHourglassPart) {
  for (const Sample& sample : samples())
    for (const Strain strain : {Strain::trilinear, Strain::enhanced}) {
      const Element one = make_element(sample.moments, 0.3, rubber, {.strain = strain});
      std::array<Vec3, 8> gradients;
      for (int a = 0; a < 8; ++a)
        gradients[a] = one.gradient(a);
      const Centred positive = centred(without_negative_squares(sample.moments));
      const Matrix24 mean = mean_stiffness(one.volume, gradients, rubber), found = stiffness(one, rubber, Part::hourglass),
                     rest = 0.3 * by_nodes(hourglass_stiffness(positive, rubber, strain));
      EXPECT_LT((in_double(sample.moments, 0.3, strain) - rest - mean).norm(), 1e-14 * mean.norm());
      EXPECT_LT((stiffness(one, rubber) - found - mean).norm(), 1e-14 * mean.norm());
      EXPECT_LT((found - rest).norm(), 1e-7 * rest.norm());
    }
}

TEST(Element, MassIsDensityTimesShapeIntegrals) {
  const double h = 0.3;
  for (const Sample& sample : samples()) {
    const Element element = make_element(sample.moments, h, rubber, {});
    double sum = 0;
    for (int a = 0; a < 8; ++a) {
      double integral = 0;
      for (const auto& [x, weight] : sample.rule)
        integral += weight * shape(a, x);
      EXPECT_NEAR(element.mass[a], rubber.density * h * h * h * integral, 1e-12);
      sum += element.mass[a];
    }
    EXPECT_NEAR(sum, rubber.density * element.volume, 1e-12);
    EXPECT_NEAR(element.volume, h * h * h * sample.moments[0], 1e-17);
  }
}

TEST(Element, GradientIsTheMeanOverTheMaterial) {
  const double h = 0.3;
  for (const Sample& sample : samples()) {
    const Element element = make_element(sample.moments, h, rubber, {});
    Vec3 sum = Vec3::Zero();
    for (int a = 0; a < 8; ++a) {
      Vec3 integral = Vec3::Zero();
      double volume = 0;
      for (const auto& [x, weight] : sample.rule) {
        integral += weight * shape_gradient(a, x) / h;
        volume += weight;
      }
      EXPECT_LT((element.gradient(a) - integral / volume).norm(), 1e-12);
      sum += element.gradient(a);
    }
    EXPECT_LT(sum.norm(), 1e-12);
  }
}

TEST(Element, ScalesWithTheCube) {
  const Sample& sample = samples().front();
  const Element one = make_element(sample.moments, 1, rubber, {}),
                small = make_element(sample.moments, 0.01, rubber, {});
  EXPECT_LT((0.01 * stiffness(one, rubber) - stiffness(small, rubber)).norm(), 1e-9 * stiffness(one, rubber).norm());
  for (int a = 0; a < 8; ++a) {
    EXPECT_NEAR(small.mass[a], 1e-6 * one.mass[a], 1e-15);
    EXPECT_LT((0.01 * small.gradient(a) - one.gradient(a)).norm(), 1e-13);
  }
}

/// A corner of a cube that is cut off at t from each of its edges: no mass is negative, and down to where the smallest
/// one drowns in round-off, all are positive.
TEST(Element, SliverMassesAreNotNegative) {
  for (const double t : {1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8})
    for (int vertex = 0; vertex < 8; ++vertex) {
      Draw draw(5);
      Body body = make_block({1, 1, 1}, 1, draw, {0.5, 0.5});
      Body sliver{{body.grid, grid::Cuts(body.grid)}};
      std::vector<grid::EdgeCut> skin;
      for (const auto e : ids<grid::EdgeId>(body.grid.n_edges()))
        if (body.cuts.is_cut(e))
          skin.push_back({e, body.grid.is_material(body.grid.ends(e)[0]) ? t : 1 - t, Vec3::Unit(body.grid.axis(e)),
                          grid::skin_label});
      sliver.cut(skin);
      const grid::Copy& copy = sliver.complex.copies[grid::CopyId(vertex)];
      const Element element = make_element(material_moments(sliver, copy), 1, rubber, {});
      for (int a = 0; a < 8; ++a)
        EXPECT_TRUE(element.mass[a] > 0 || (element.mass[a] == 0 && t < 1e-4))
          << "t " << t << ", octant " << vertex << ", vertex " << a << ": " << element.mass[a];
    }
}

} // namespace
} // namespace kerf::fem::element_test
