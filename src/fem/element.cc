#include "fem/element.h"

#include "fem/dilatation.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <bit>
#include <cmath>

namespace kerf::fem {

namespace {

using Linear = std::array<double, 2>; // coefficients of 1, x

Linear shape_factor(const int vertex, const int axis) { return vertex >> axis & 1 ? Linear{0, 1} : Linear{1, -1}; }

/// Integral of N_a over the material in the unit cube.
double integral_of_shape(const Moments& m, const int a) {
  const Linear x = shape_factor(a, 0), y = shape_factor(a, 1), z = shape_factor(a, 2);
  double sum = 0;
  for (int k = 0; k < 2; ++k)
    for (int j = 0; j < 2; ++j)
      for (int i = 0; i < 2; ++i)
        sum += x[i] * y[j] * z[k] * m[i + 3 * j + 9 * k];
  return sum;
}

/// Integral of N_a N_b over the material in the unit cube.
double integral_of_product(const Moments& m, const int a, const int b) {
  std::array<std::array<double, 3>, 3> f;
  for (int axis = 0; axis < 3; ++axis) {
    const Linear p = shape_factor(a, axis), q = shape_factor(b, axis);
    f[axis] = {p[0] * q[0], p[0] * q[1] + p[1] * q[0], p[1] * q[1]};
  }
  double sum = 0;
  for (int n = 0; n < 27; ++n)
    sum += f[0][n % 3] * f[1][n / 3 % 3] * f[2][n / 9] * m[n];
  return sum;
}

void fill_mass(Element& element, const Moments& moments, const double mass_of_cube) {
  for (int a = 0; a < 8; ++a) // Far from a sliver the integral is below the round-off of its moments, or even negative.
    element.mass[a] = mass_of_cube * std::max(0.0, integral_of_shape(moments, a));
}

/// Powers of a symmetric matrix on a vector: returns the growth of the last of n.
__attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default"))) double growth(const double (&K)[24][24],
                                                                                             const int n) {
  double v[24], w[24];
  for (int i = 0; i < 24; ++i)
    v[i] = std::cos(1 + 2.4 * i); // of no symmetry
  double norm = 0;
  for (int k = 0; k <= n; ++k) { // the first length is that of the start
    double squares[4] = {};
    for (int i = 0; i < 24; ++i)
      squares[i % 4] += v[i] * v[i];
    norm = std::sqrt((squares[0] + squares[1]) + (squares[2] + squares[3]));
    if (k == n)
      break;
    const double scale = 1 / norm;
    for (double& wi : w)
      wi = 0;
    for (int j = 0; j < 24; ++j) {
      const double vj = scale * v[j];
      for (int i = 0; i < 24; ++i)
        w[i] += vj * K[j][i];
    }
    std::copy(w, w + 24, v);
  }
  return norm;
}

} // namespace

Element make_element(const Moments& moments, const double h, const material::Elastic& material,
                     const ElementOptions& options) {
  Element element;
  element.volume = moments[0] * h * h * h;
  const Moments positive = without_negative_squares(moments);
  fill_mass(element, positive, material.density * h * h * h);

  // Affine motions meet exact forces where the mean gradient is that of the material as it is.
  const Centred as_it_lies = centred(moments);
  element.centroid = as_it_lies.centroid;
  const std::array<Vec3, 8> gradients = mean_gradients(as_it_lies); // of a unit cube
  for (int k = 0; k < 4; ++k) {
    element.mode_gradient[k].setZero();
    for (int a = 0; a < 8; ++a)
      element.mode_gradient[k] += sign(hourglass_modes[k], a) / (8 * h) * gradients[a];
  }
  element.slope = 1 / (4 * h);
  const MatrixOfModes K = h * hourglass_stiffness(centred(positive), material, options.strain);
  for (int p = 0; p < n_hourglass; ++p)
    for (int q = 0; q <= p; ++q)
      element.hourglass[pair_index(p, q)] = static_cast<float>(0.5 * (K(p, q) + K(q, p)));
  element.bound = jacobi_bound(element, material);
  if (const std::optional<material::Elastic> rest = without_excess(material, options.strain))
    element.bound = std::max(element.bound, jacobi_bound(element, *rest));
  return element;
}

Vec3 Element::gradient(const int a) const {
  Vec3 b;
  for (int j = 0; j < 3; ++j)
    b[j] = (a >> j & 1) != 0 ? slope : -slope;
  for (int k = 0; k < 4; ++k)
    b += sign(hourglass_modes[k], a) * mode_gradient[k];
  return b;
}

Matrix24 stiffness(const Element& element, const material::Elastic& material, const Part part) {
  MatrixOfModes of_modes;
  for (int p = 0; p < n_hourglass; ++p)
    for (int q = 0; q <= p; ++q)
      of_modes(p, q) = of_modes(q, p) = element.hourglass[pair_index(p, q)];
  Matrix24 K = by_nodes(of_modes);
  if (part == Part::whole) {
    std::array<Vec3, 8> gradients;
    for (int a = 0; a < 8; ++a)
      gradients[a] = element.gradient(a);
    K += mean_stiffness(element.volume, gradients, material);
  }
  return 0.5 * (K + K.transpose());
}

double jacobi_bound(const Element& element, const material::Elastic& material) {
  constexpr int n_iterations = 16;
  constexpr double most = 8, unseen = 1.05; // by so few iterations
  const Matrix24 K = stiffness(element, material);
  std::array<Mat3, 8> inverse; // of the factors of the diagonal blocks
  for (int a = 0; a < 8; ++a) {
    Mat3 D = K.block<3, 3>(3 * a, 3 * a);
    D += 1e-9 * (D.trace() + 1e-300) * Mat3::Identity();
    const Eigen::LLT<Mat3> factor(D);
    inverse[a] = factor.matrixL().solve(Mat3::Identity());
  }
  double scaled[24][24];
  for (int a = 0; a < 8; ++a)
    for (int b = 0; b < 8; ++b) {
      const Mat3 block = inverse[a] * K.block<3, 3>(3 * a, 3 * b) * inverse[b].transpose();
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          scaled[3 * a + i][3 * b + j] = block(i, j);
    }
  const double bound = growth(scaled, n_iterations);
  return std::isfinite(bound) ? std::min(most, unseen * bound) : most;
}

Eigen::Matrix<double, 8, 8> consistent_mass(const Moments& moments, const double mass_of_cube) {
  const Moments positive = without_negative_squares(moments);
  Eigen::Matrix<double, 8, 8> mass;
  for (int a = 0; a < 8; ++a)
    for (int b = 0; b <= a; ++b)
      mass(a, b) = mass(b, a) = mass_of_cube * integral_of_product(positive, a, b);
  return mass;
}

} // namespace kerf::fem
