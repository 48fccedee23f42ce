#include "fem/fields.h"

#include "tests/fem/models.h"
#include "tests/fem/statics.h"
#include "tests/geometry/meshes.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <bit>

namespace kerf::fem::fields_test {
namespace {

const material::Elastic rubber{.density = 1000, .youngs_modulus = 2e3, .poissons_ratio = 0.4};

/// Under every law, in bodies cut anywhere: a uniform state has its strain and stress at every copy and corner.
TEST(Fields, UniformStatesAreExact) {
  for (const std::string& law : all_laws) {
    Draw draw(95);
    Body body = make_block({3, 3, 3}, 0.2, draw, {0.1, 0.9});
    cut_at_random(body, 0.3, draw, {0.1, 0.9});
    const Hexahedra model = make_model(body, {.material = with_law(rubber, law)});
    const Mat3 F = Mat3::Identity() + 0.1 * draw.matrix();
    Points x;
    for (const Vec3& X : body.rest())
      x.push_back(F * X + Vec3(1, 2, 3));
    const Mat3 strain = law == "small strain" ? Mat3(0.5 * (F + F.transpose()) - Mat3::Identity())
                                              : Mat3(0.5 * (F.transpose() * F - Mat3::Identity()));
    const Mat3 stress = material::cauchy_stress(model.law(), F);
    for (const Mat3& e : at_corners(model, body.rest(), strain_of_copies(model, x)))
      EXPECT_LT((e - strain).norm(), 1e-10) << law;
    for (const Mat3& s : at_corners(model, body.rest(), stress_of_copies(model, x)))
      EXPECT_LT((s - stress).norm(), 1e-10 * rubber.youngs_modulus) << law;
  }
}

/// Displacements of second order have strains of first order: right at every corner of full cells, on the skin too.
TEST(Fields, LinearStrainsAreRecovered) {
  Draw draw(96);
  const Body body = make_embedded(geometry::box_mesh(Vec3::Zero(), Vec3(1, 1, 1)), 0.25, Vec3::Constant(0.5));
  const Hexahedra model =
    make_model(body, {.material = with_law(rubber, "small strain"), .boundary = Boundary::full_cube});
  std::array<Mat3, 3> H; // u_i = X^T H_i X / 2
  for (Mat3& h : H) {
    const Mat3 A = draw.matrix();
    h = A + A.transpose();
  }
  const Points rest = body.rest();
  Points x = rest;
  std::vector<Mat3> expected;
  for (Vec3& p : x) {
    const Vec3 X = p;
    Mat3 G;
    for (int i = 0; i < 3; ++i) {
      p[i] += 0.5 * X.dot(H[i] * X);
      G.row(i) = (H[i] * X).transpose();
    }
    const Mat3 e = 0.5 * (G + G.transpose());
    expected.push_back(rubber.lambda() * e.trace() * Mat3::Identity() + 2 * rubber.mu() * e);
  }
  const auto found = at_corners(model, rest, stress_of_copies(model, x));
  for (std::size_t c = 0; c < rest.size(); ++c)
    EXPECT_LT((found[c] - expected[c]).norm(), 1e-11 * rubber.youngs_modulus) << rest[c].transpose();
}

/// A plane cut lets one half be stretched and the other not: neither feels the other's stress.
TEST(Fields, DoNotReachAcrossACut) {
  Draw draw(97);
  Body body = make_block({4, 3, 3}, 0.2, draw, {0.5, 0.5});
  cut_plane(body, 0, 2, 0.4);
  const Hexahedra model = make_model(body, {.material = rubber});
  std::vector<std::uint32_t> piece(body.complex.n_corners());
  for (const grid::Copy& copy : body.complex.copies) {
    const auto node = body.grid.nodes(copy.cell)[std::countr_zero(copy.nodes)];
    for (const auto corner : copy.corners)
      piece[corner.value] = body.grid.index(node)[0] > 2;
  }
  Points x = body.rest();
  for (std::size_t c = 0; c < x.size(); ++c)
    if (piece[c] == 1)
      x[c][1] *= 1.5;
  const auto stress = at_corners(model, body.rest(), stress_of_copies(model, x));
  double most = 0;
  for (std::size_t c = 0; c < x.size(); ++c)
    if (piece[c] == 0)
      EXPECT_LT(stress[c].norm(), 1e-11 * rubber.youngs_modulus);
    else
      most = std::max(most, stress[c].norm());
  EXPECT_GT(most, 0.3 * rubber.youngs_modulus);
}

TEST(Fields, VonMisesOfPullAndShear) {
  EXPECT_NEAR(von_mises(Vec3(7, 0, 0).asDiagonal()), 7, 1e-14);
  EXPECT_NEAR(von_mises(Mat3::Identity()), 0, 1e-15);
  Mat3 shear = Mat3::Zero();
  shear(0, 1) = shear(1, 0) = 2;
  EXPECT_NEAR(von_mises(shear), 2 * std::sqrt(3.0), 1e-14);
}

} // namespace
} // namespace kerf::fem::fields_test
