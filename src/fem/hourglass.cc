#include "fem/hourglass.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include <algorithm>
#include <bit>
#include <cmath>

namespace kerf::fem {

namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
/// 6 engineering strains for each of the 6 monomials, a column a mode.
template <int n>
using Strains = Eigen::Matrix<double, 36, n>;

/// The linear monomials are 0, 1, 2; that of the product of two axes is 3 + this.
constexpr int product_of(const int i, const int j) { return i + j == 1 ? 0 : i + j == 3 ? 1 : 2; }

/// Engineering strains (xx, yy, zz, xy, yz, zx) of du_i / dx_j.
constexpr int strain_index(const int i, const int j) { return i == j ? i : 3 + product_of(i, j); }

double binomial(const int n, const int k) { return n == 2 && k == 1 ? 2 : 1; }

/// Moments about `centre`, one axis at a time.
Moments shifted(const Moments& moments, const Vec3& centre) {
  Moments m = moments;
  int stride = 1;
  for (int axis = 0; axis < 3; ++axis, stride *= 3) {
    const Moments before = m;
    const double by = -centre[axis], to_power[3] = {1, by, by * by};
    for (int n = 0; n < 27; ++n) {
      const int power = n / stride % 3;
      m[n] = 0;
      for (int k = 0; k <= power; ++k)
        m[n] += binomial(power, k) * to_power[power - k] * before[n + (k - power) * stride];
    }
  }
  return m;
}

/// Exponents of the monomials, as indices into the moments.
constexpr std::array<int, 6> monomials = {1, 3, 9, 1 + 3, 3 + 9, 9 + 1};

/// Square root of D on engineering strains, for an edge of 1 m.
Matrix6 root_of_elasticity(const material::Elastic& material) {
  const double shear = std::sqrt(2 * material.mu());
  const double bulk = std::sqrt(3 * material.lambda() + 2 * material.mu());
  Matrix6 D = Matrix6::Zero();
  D.topLeftCorner<3, 3>() = Mat3::Constant((bulk - shear) / 3) + shear * Mat3::Identity();
  D.bottomRightCorner<3, 3>() = std::sqrt(material.mu()) * Mat3::Identity();
  return D;
}

/// L with L L^T = gram; columns that vanish stand for a rank below six.
Matrix6 factor_of(const Matrix6& gram) {
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(gram);
  return solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

/// Value and slope of the factor of N_a along an axis, at the centroid.
struct Factor {
  double value, slope;
};
Factor factor(const int vertex, const int axis, const Vec3& centroid) {
  return vertex >> axis & 1 ? Factor{centroid[axis], 1} : Factor{1 - centroid[axis], -1};
}

/// grad N_a less its mean, as coefficients of the monomials.
using Gradient = Eigen::Matrix<double, 6, 3>;

std::array<Gradient, 8> gradients(const Vec3& centroid) {
  std::array<Gradient, 8> all;
  for (int a = 0; a < 8; ++a) {
    all[a].setZero();
    for (int j = 0; j < 3; ++j) {
      const int k = (j + 1) % 3, l = (j + 2) % 3;
      const Factor fj = factor(a, j, centroid), fk = factor(a, k, centroid), fl = factor(a, l, centroid);
      all[a](k, j) = fj.slope * fk.slope * fl.value;
      all[a](l, j) = fj.slope * fk.value * fl.slope;
      all[a](3 + product_of(k, l), j) = fj.slope * fk.slope * fl.slope;
    }
  }
  return all;
}

/// Hooke's stiffness of two nodes, for g(i, j) = int N_a,i N_b,j.
Mat3 stiffness_block(const Mat3& g, const material::Elastic& material) {
  return material.lambda() * g + material.mu() * (g.transpose() + g.trace() * Mat3::Identity());
}

/// Of hourglass modes of amplitude 1, less their means.
std::array<Gradient, 4> gradients_of_modes(const Centred& moments) {
  const auto of_vertices = gradients(moments.centroid);
  std::array<Gradient, 4> all;
  for (int k = 0; k < 4; ++k) {
    all[k].setZero();
    for (int a = 0; a < 8; ++a)
      all[k] += 0.125 * sign(hourglass_modes[k], a) * of_vertices[a];
  }
  return all;
}

MatrixOfModes trilinear_stiffness(const Centred& moments, const material::Elastic& material) {
  const auto gradient = gradients_of_modes(moments);
  MatrixOfModes K;
  for (int l = 0; l < 4; ++l) {
    const Gradient weighted = moments.gram * gradient[l];
    for (int k = 0; k <= l; ++k) {
      const Mat3 block = stiffness_block(gradient[k].transpose() * weighted, material);
      K.block<3, 3>(3 * k, 3 * l) = block;
      K.block<3, 3>(3 * l, 3 * k) = block.transpose();
    }
  }
  return K;
}

/// Strains of the hourglass modes.
Strains<n_hourglass> strains_of_modes(const Centred& moments) {
  const auto gradient = gradients_of_modes(moments);
  Strains<n_hourglass> H = Strains<n_hourglass>::Zero();
  for (int k = 0; k < 4; ++k)
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        for (int q = 0; q < 6; ++q)
          H(6 * q + strain_index(i, j), 3 * k + i) += gradient[k](q, j);
  return H;
}

/// Strains of the 12 modes of an element's own.
Strains<12> enhanced_strains() {
  Strains<12> M = Strains<12>::Zero();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      M(6 * j + strain_index(i, j), 3 * i + j) = 1;
  for (int q = 0; q < 3; ++q)
    M.col(9 + q).segment<3>(6 * (3 + q)).setOnes();
  return M;
}

/// A S for A^T A = G x D: six rows for each column of L.
template <int n>
Strains<n> weighted(const Matrix6& L, const Matrix6& root, const Strains<n>& S) {
  Strains<n> result;
  for (int k = 0; k < 6; ++k) {
    Eigen::Matrix<double, 6, n> sum = L(0, k) * S.template topRows<6>();
    for (int q = 1; q < 6; ++q)
      sum += L(q, k) * S.template middleRows<6>(6 * q);
    result.template middleRows<6>(6 * k).noalias() = root * sum;
  }
  return result;
}

/// Least squares for the modes: |Y u + Z a|^2 is least over a, and what is left of Y u is the element's strain.
struct OwnModes {
  Strains<n_hourglass> Y;
  Eigen::Matrix<double, 12, 1> scale; ///< of the columns of Z to those of unit length
  Eigen::ColPivHouseholderQR<Strains<12>> qr;

  OwnModes(const Centred& moments, const material::Elastic& material);
  /// What of Y is orthogonal to the columns of Z, in the coordinates of an orthonormal basis; the first rows are zero.
  Strains<n_hourglass> remainder() const;
};

/// Columns of hardly any length are round-off, and left out; so are those that the others span.
OwnModes::OwnModes(const Centred& moments, const material::Elastic& material) {
  constexpr double vanishing = 1e-6, dependent = 1e-8;
  const Matrix6 L = factor_of(moments.gram), root = root_of_elasticity(material);
  Y = weighted(L, root, strains_of_modes(moments));
  Strains<12> Z = weighted(L, root, enhanced_strains());
  const double longest = Z.colwise().norm().maxCoeff();
  for (int i = 0; i < 12; ++i) {
    const double length = Z.col(i).norm();
    scale[i] = length > vanishing * longest ? 1 / length : 0;
    Z.col(i) *= scale[i];
  }
  qr.setThreshold(dependent);
  qr.compute(Z);
}

Strains<n_hourglass> OwnModes::remainder() const {
  Strains<n_hourglass> turned = qr.householderQ().adjoint() * Y;
  turned.topRows(qr.rank()).setZero();
  return turned;
}

MatrixOfModes enhanced_stiffness(const Centred& moments, const material::Elastic& material) {
  const auto Y = OwnModes(moments, material).remainder();
  return Y.transpose() * Y;
}

/// Of displacements.
Gradients displacement_gradients(const Vec3& centroid) {
  const auto gradient = gradients(centroid);
  Gradients H = Gradients::Zero();
  for (int a = 0; a < 8; ++a)
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        for (int q = 0; q < 6; ++q)
          H(9 * q + 3 * j + i, 3 * a + i) = gradient[a](q, j);
  return H;
}

/// Of the modes of an element's own (enhanced_strains()).
Eigen::Matrix<double, 54, 12> enhanced_gradients() {
  Eigen::Matrix<double, 54, 12> M = Eigen::Matrix<double, 54, 12>::Zero();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      M(9 * j + 3 * j + i, 3 * i + j) = 1;
  for (int q = 0; q < 3; ++q)
    for (int i = 0; i < 3; ++i)
      M(9 * (3 + q) + 3 * i + i, 9 + q) = 1;
  return M;
}

} // namespace

Centred centred(const Moments& moments) {
  Centred result;
  result.volume = moments[0];
  result.centroid = Vec3(moments[1], moments[3], moments[9]) / result.volume;
  const Moments m = shifted(moments, result.centroid);
  Eigen::Matrix<double, 6, 1> sums;
  for (int p = 0; p < 6; ++p)
    sums[p] = p < 3 ? 0 : m[monomials[p]];
  for (int p = 0; p < 6; ++p)
    for (int q = 0; q < 6; ++q)
      result.gram(p, q) = m[monomials[p] + monomials[q]] - sums[p] * sums[q] / result.volume;
  result.mean_products = sums.tail<3>() / result.volume;
  return result;
}

std::array<Vec3, 8> mean_gradients(const Centred& moments) {
  std::array<Vec3, 8> gradient;
  for (int a = 0; a < 8; ++a)
    for (int j = 0; j < 3; ++j) {
      const int k = (j + 1) % 3, l = (j + 2) % 3;
      const Factor fj = factor(a, j, moments.centroid), fk = factor(a, k, moments.centroid),
                   fl = factor(a, l, moments.centroid);
      gradient[a][j] = fj.slope * (fk.value * fl.value + fk.slope * fl.slope * moments.mean_products[product_of(k, l)]);
    }
  return gradient;
}

int sign(const int mode, const int vertex) { return std::popcount(unsigned(mode & ~vertex)) % 2 == 0 ? 1 : -1; }

Matrix24 by_nodes(const MatrixOfModes& by_modes) {
  Matrix24 K;
  for (int a = 0; a < 8; ++a) {
    Eigen::Matrix<double, 3, n_hourglass> of_a = Eigen::Matrix<double, 3, n_hourglass>::Zero();
    for (int k = 0; k < 4; ++k)
      of_a += sign(hourglass_modes[k], a) * by_modes.middleRows<3>(3 * k);
    for (int b = 0; b < 8; ++b) {
      Mat3 block = Mat3::Zero();
      for (int l = 0; l < 4; ++l)
        block += sign(hourglass_modes[l], b) * of_a.middleCols<3>(3 * l);
      K.block<3, 3>(3 * a, 3 * b) = block;
    }
  }
  return K;
}

MatrixOfModes hourglass_stiffness(const Centred& moments, const material::Elastic& material, const Strain strain) {
  return strain == Strain::enhanced ? enhanced_stiffness(moments, material) : trilinear_stiffness(moments, material);
}

Gradients hourglass_gradients(const Centred& moments, const material::Elastic& material, const Strain strain) {
  Gradients H = displacement_gradients(moments.centroid);
  if (strain == Strain::enhanced) {
    const OwnModes own(moments, material);
    const Eigen::Matrix<double, 12, n_hourglass> of_modes = own.scale.asDiagonal() * own.qr.solve(own.Y);
    const Eigen::Matrix<double, 54, n_hourglass> gradients_by_modes = enhanced_gradients() * of_modes;
    for (int a = 0; a < 8; ++a)
      for (int k = 0; k < 4; ++k)
        H.middleCols<3>(3 * a) -= sign(hourglass_modes[k], a) * gradients_by_modes.middleCols<3>(3 * k);
  }
  return H;
}

Matrix24 mean_stiffness(const double volume, const std::array<Vec3, 8>& gradient, const material::Elastic& material) {
  Matrix24 K;
  for (int a = 0; a < 8; ++a)
    for (int b = 0; b < 8; ++b)
      K.block<3, 3>(3 * a, 3 * b) = stiffness_block(volume * gradient[a] * gradient[b].transpose(), material);
  return K;
}

} // namespace kerf::fem
