#include "fem/hexahedra.h"

#include "base/parallel.h"
#include "dynamics/state.h"
#include "fem/kernels.h"
#include "tests/fem/bodies.h"

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

namespace kerf::fem {
namespace {

using Matrix = Eigen::MatrixXd;

const material::Elastic rubber{.density = 1000, .youngs_modulus = 2e3, .poissons_ratio = 0.4};

/// K by products with unit vectors.
Matrix assembled(const Hexahedra& model) {
  const auto n = static_cast<Eigen::Index>(3 * model.lumped_mass().size());
  Matrix K(n, n);
  Eigen::VectorXd p = Eigen::VectorXd::Zero(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    p[i] = 1;
    model.apply_stiffness({p.data(), p.data() + n}, {K.col(i).data(), K.col(i).data() + n});
    p[i] = 0;
  }
  return K;
}

/// Eigenvalues of K scaled to a unit diagonal: as many vanish, but a sliver's stiffness does not look like zero.
Eigen::VectorXd scaled_spectrum(const Matrix& K) {
  const Eigen::VectorXd s = K.diagonal().cwiseSqrt().cwiseInverse();
  const Matrix scaled = s.asDiagonal() * K * s.asDiagonal();
  return Eigen::SelfAdjointEigenSolver<Matrix>(scaled, Eigen::EigenvaluesOnly).eigenvalues();
}

Points disturbed(const Points& rest, const Mat3& F, const double size, Draw& draw) {
  Points x = rest;
  for (Vec3& p : x)
    p = F * p + size * draw.vector();
  return x;
}

TEST(Stiffness, HasSixRigidModesAPiece) {
  Draw draw(31);
  std::size_t n_several = 0;
  double least = 1, most = 0;
  for (int n = 0; n < 24; ++n) {
    Body body = make_block({2, 2, 1 + n % 3}, 0.2, draw, {0.25, 0.75});
    cut_at_random(body, 0.2 + 0.2 * (n % 4), draw, {0.25, 0.75});
    for (const double weight : {0.0, 0.03}) {
      const Hexahedra model(body, {.material = rubber, .ghost_penalty = {.weight = weight}});
      const Eigen::VectorXd spectrum = scaled_spectrum(assembled(model));
      const std::uint32_t n_pieces = grid::n_pieces(body.complex);
      const Eigen::Index n_rigid = 6 * n_pieces;
      ASSERT_GT(spectrum.size(), n_rigid);
      EXPECT_LT(spectrum.head(n_rigid).cwiseAbs().maxCoeff(), 1e-13) << n_pieces << " pieces";
      EXPECT_GT(spectrum[n_rigid], 1e-4) << n_pieces << " pieces";
      most = std::max(most, spectrum.head(n_rigid).cwiseAbs().maxCoeff());
      least = std::min(least, spectrum[n_rigid]);
    }
    n_several += grid::n_pieces(body.complex) > 1;
  }
  EXPECT_GE(n_several, 5u);
  RecordProperty("least", std::to_string(least * 1e9) + "e-9");
  RecordProperty("most", std::to_string(most * 1e16) + "e-16");
}

TEST(Stiffness, ProductsAreThoseOfASymmetricMatrix) {
  Draw draw(32);
  Body body = make_block({2, 3, 2}, 0.2, draw, {0.2, 0.8});
  cut_at_random(body, 0.3, draw, {0.2, 0.8});
  Hexahedra model(body, {.material = rubber});
  model.linearise(disturbed(body.rest(), draw.rotation(), 0.03, draw));
  const Matrix K = assembled(model);
  EXPECT_LT((K - K.transpose()).norm(), 1e-15 * K.norm());
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Matrix>(K, Eigen::EigenvaluesOnly).eigenvalues()[0], -1e-13 * K.norm());

  Points p(body.complex.n_corners()), y(p.size());
  for (Vec3& v : p)
    v = draw.vector();
  model.apply_stiffness(dynamics::flat(p), dynamics::flat(y));
  const Eigen::VectorXd expected = K * Eigen::Map<const Eigen::VectorXd>(p[0].data(), K.cols());
  EXPECT_LT((Eigen::Map<const Eigen::VectorXd>(y[0].data(), K.cols()) - expected).norm(), 1e-14 * expected.norm());

  std::vector<Mat3> blocks;
  model.stiffness_diagonal(blocks);
  ASSERT_EQ(blocks.size(), p.size());
  for (std::size_t c = 0; c < blocks.size(); ++c)
    EXPECT_LT((blocks[c] - K.block<3, 3>(3 * c, 3 * c)).norm(), 1e-14 * K.norm());
}

/// Element by element, from make_element and the copies' corners alone.
TEST(Stiffness, IsTheSumOfItsElements) {
  Draw draw(33);
  Body body = make_block({2, 2, 2}, 0.2, draw, {0.2, 0.8});
  cut_at_random(body, 0.3, draw, {0.2, 0.8});
  const Hexahedra model(body, {.material = rubber, .ghost_penalty = {.weight = 0}});
  const Matrix found = assembled(model);
  Matrix K = Matrix::Zero(found.rows(), found.cols());
  for (const grid::Copy& copy : body.complex.copies) {
    const Element element = make_element(material_moments(body, copy), body.grid.h(), rubber, {});
    const Eigen::Map<const Matrix24> k(element.stiffness.data());
    for (int a = 0; a < 8; ++a)
      for (int b = 0; b < 8; ++b)
        K.block<3, 3>(3 * copy.corners[a].value, 3 * copy.corners[b].value) += k.block<3, 3>(3 * a, 3 * b);
  }
  EXPECT_LT((K - found).norm(), 1e-14 * K.norm());
}

TEST(Stiffness, TurnsWithTheBody) {
  Draw draw(34);
  Body body = make_block({2, 2, 2}, 0.2, draw, {0.2, 0.8});
  cut_at_random(body, 0.3, draw, {0.2, 0.8});
  Hexahedra model(body, {.material = rubber});
  const Matrix at_rest = assembled(model);
  const Mat3 Q = draw.rotation();
  model.linearise(disturbed(body.rest(), Q, 0, draw));
  Matrix turned = assembled(model);
  for (Eigen::Index a = 0; a < turned.rows(); a += 3)
    for (Eigen::Index b = 0; b < turned.cols(); b += 3)
      turned.block<3, 3>(a, b) = (Q.transpose() * turned.block<3, 3>(a, b) * Q).eval();
  EXPECT_LT((turned - at_rest).norm(), 1e-13 * at_rest.norm());
}

TEST(Stiffness, IsTheDerivativeOfTheForceAtRest) {
  Draw draw(35);
  Body body = make_block({2, 2, 2}, 0.2, draw, {0.2, 0.8});
  cut_at_random(body, 0.4, draw, {0.2, 0.8});
  const Hexahedra model(body, {.material = rubber});
  const Matrix K = assembled(model);
  const Points rest = body.rest();
  const double eps = 1e-5 * body.grid.h();
  Matrix derivative(K.rows(), K.cols());
  Points x = rest, forward, backward;
  for (std::size_t i = 0; i < 3 * rest.size(); ++i) {
    const double at = dynamics::flat(rest)[i];
    dynamics::flat(x)[i] = at + eps;
    model.force(x, forward);
    dynamics::flat(x)[i] = at - eps;
    model.force(x, backward);
    dynamics::flat(x)[i] = at;
    for (std::size_t j = 0; j < 3 * rest.size(); ++j)
      derivative(j, i) = (dynamics::flat(forward)[j] - dynamics::flat(backward)[j]) / (2 * eps);
  }
  EXPECT_LT((derivative + K).norm(), 1e-8 * K.norm());
  RecordProperty("error", std::to_string((derivative + K).norm() / K.norm() * 1e10) + "e-10");
}

/// Elements for the kernels: 37 of five kinds, at 50 corners.
struct Kernels {
  static constexpr std::size_t n = 37, n_corners = 50, stride = 600;
  std::vector<double> kinds, rotations, tangents, p;
  std::vector<std::uint32_t> corners, element;

  Kernels() : kinds(5 * stride), p(3 * n_corners) {
    Draw draw(36);
    for (std::vector<double>* values : {&kinds, &p})
      for (double& value : *values)
        value = draw(-1, 1);
    for (std::size_t e = 0; e < n; ++e) {
      element.push_back(static_cast<std::uint32_t>(draw(0, 5)));
      const Mat3 R = draw.rotation();
      rotations.insert(rotations.end(), R.data(), R.data() + 9);
      for (int a = 0; a < 8; ++a)
        corners.push_back(static_cast<std::uint32_t>(draw(0, n_corners)));
      const material::Tangent A = material::Tangent::Random();
      const material::Tangent symmetric = A + A.transpose();
      tangents.insert(tangents.end(), symmetric.data(), symmetric.data() + 81);
    }
  }
  ElementBlock block() const {
    return {n, corners.data(), element.data(), kinds.data(), kinds.data() + 576, stride, rotations.data()};
  }
  Vec3 at(const std::size_t e, const int a) const { return Eigen::Map<const Vec3>(&p[3 * corners[8 * e + a]]); }
};

TEST(Stiffness, KernelIsTheProductsOfItsMatrices) {
  const Kernels kernels;
  std::vector<double> out(24 * Kernels::n, 1e300);
  apply_stiffness(kernels.block(), kernels.p.data(), out.data());
  for (std::size_t e = 0; e < Kernels::n; ++e) {
    Matrix24 R = Matrix24::Zero();
    Vector24 q;
    for (int a = 0; a < 8; ++a) {
      R.block<3, 3>(3 * a, 3 * a) = Eigen::Map<const Mat3>(&kernels.rotations[9 * e]);
      q.segment<3>(3 * a) = kernels.at(e, a);
    }
    const Eigen::Map<const Matrix24> K(&kernels.kinds[Kernels::stride * kernels.element[e]]);
    const Vector24 expected = R * (K * (R.transpose() * q));
    EXPECT_LT((Eigen::Map<const Vector24>(&out[24 * e]) - expected).norm(), 1e-13);
  }
}

TEST(Stiffness, KernelOfTangentsIsTheProductsOfThem) {
  const Kernels kernels;
  std::vector<double> out(24 * Kernels::n, 1);
  add_mean_tangent(kernels.block(), kernels.tangents.data(), kernels.p.data(), out.data());
  for (std::size_t e = 0; e < Kernels::n; ++e) {
    const double* const gradients = &kernels.kinds[Kernels::stride * kernels.element[e] + 576];
    Mat3 G = Mat3::Zero(), P;
    for (int a = 0; a < 8; ++a)
      G += kernels.at(e, a) * Eigen::Map<const Vec3>(gradients + 3 * a).transpose();
    Eigen::Map<Eigen::Matrix<double, 9, 1>>(P.data()) = Eigen::Map<const material::Tangent>(&kernels.tangents[81 * e]) *
                                                        Eigen::Map<const Eigen::Matrix<double, 9, 1>>(G.data());
    for (int a = 0; a < 8; ++a) {
      const Vec3 expected = Vec3::Ones() + P * Eigen::Map<const Vec3>(gradients + 3 * a);
      EXPECT_LT((Eigen::Map<const Vec3>(&out[24 * e + 3 * a]) - expected).norm(), 1e-13);
    }
  }
}

TEST(Stiffness, OneAndTwoThreadsGiveTheSameBits) {
  const int n_before = n_threads();
  std::array<std::vector<double>, 2> results;
  for (const int n : {1, 2}) {
    set_n_threads(n);
    Draw draw(37);
    Body body = make_block({6, 5, 7}, 0.1, draw, {0.1, 0.9});
    cut_at_random(body, 0.2, draw, {0.1, 0.9});
    Hexahedra model(body, {.material = rubber});
    const Points x = disturbed(body.rest(), draw.rotation(), 0.02, draw);
    model.linearise(x);
    Points f, y(x.size());
    model.force(x, f);
    model.apply_stiffness(dynamics::flat(x), dynamics::flat(y));
    std::vector<double>& result = results[n - 1];
    result = {model.energy(x), model.volume()};
    for (const Points& part : {f, y})
      result.insert(result.end(), dynamics::flat(part).begin(), dynamics::flat(part).end());
    result.insert(result.end(), model.lumped_mass().begin(), model.lumped_mass().end());
  }
  set_n_threads(n_before);
  EXPECT_EQ(results[0], results[1]);
}

} // namespace
} // namespace kerf::fem
