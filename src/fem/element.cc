#include "fem/element.h"

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

/// Sign of a mode at a vertex.
int sign(const int mode, const int vertex) { return std::popcount(unsigned(mode & ~vertex)) % 2 == 0 ? 1 : -1; }

/// From the 24 displacements to the 12 hourglass unknowns.
using ToHourglass = Eigen::Matrix<double, n_hourglass, 24>;
const ToHourglass& to_hourglass() {
  static const ToHourglass S = [] {
    ToHourglass all = ToHourglass::Zero();
    for (int k = 0; k < 4; ++k)
      for (int a = 0; a < 8; ++a)
        for (int i = 0; i < 3; ++i)
          all(3 * k + i, 3 * a + i) = sign(hourglass_modes[k], a);
    return all;
  }();
  return S;
}

} // namespace

Element make_element(const Moments& moments, const double h, const material::Elastic& material,
                     const ElementOptions& options) {
  Element element;
  element.volume = moments[0] * h * h * h;
  const Moments positive = without_negative_squares(moments);
  fill_mass(element, positive, material.density * h * h * h);

  const Centred as_it_lies = centred(moments);
  element.centroid = as_it_lies.centroid;
  const std::array<Vec3, 8> gradients = mean_gradients(as_it_lies); // of a unit cube
  for (int k = 0; k < 4; ++k) {
    element.mode_gradient[k].setZero();
    for (int a = 0; a < 8; ++a)
      element.mode_gradient[k] += sign(hourglass_modes[k], a) / (8 * h) * gradients[a];
  }
  element.slope = 1 / (4 * h);
  // The mean gradient is that of the material as it is: so affine motions meet exact forces.
  const Matrix24 K = h * hourglass_stiffness(centred(positive), material, options.strain);
  const ToHourglass& S = to_hourglass(); // S S^T = 8
  const Eigen::Matrix<double, n_hourglass, n_hourglass> of_modes = S * K * S.transpose() / 64;
  for (int p = 0; p < n_hourglass; ++p)
    for (int q = 0; q <= p; ++q)
      element.hourglass[pair_index(p, q)] = static_cast<float>(0.5 * (of_modes(p, q) + of_modes(q, p)));
  element.bound = jacobi_bound(element, material);
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
  Eigen::Matrix<double, n_hourglass, n_hourglass> of_modes;
  for (int p = 0; p < n_hourglass; ++p)
    for (int q = 0; q <= p; ++q)
      of_modes(p, q) = of_modes(q, p) = element.hourglass[pair_index(p, q)];
  Matrix24 K = to_hourglass().transpose() * of_modes * to_hourglass();
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
  Matrix24 K = stiffness(element, material);
  for (int a = 0; a < 8; ++a) {
    Mat3 D = K.block<3, 3>(3 * a, 3 * a);
    D += 1e-9 * (D.trace() + 1e-300) * Mat3::Identity();
    const Eigen::LLT<Mat3> factor(D);
    K.middleRows<3>(3 * a) = factor.matrixL().solve(K.middleRows<3>(3 * a)).eval();
    K.middleCols<3>(3 * a) = factor.matrixL().solve(K.middleCols<3>(3 * a).transpose()).transpose().eval();
  }
  Vector24 v;
  for (int i = 0; i < 24; ++i)
    v[i] = std::cos(1 + 2.4 * i); // of no symmetry
  double bound = 0;
  for (int n = 0; n < n_iterations; ++n) {
    v.normalize();
    const Vector24 w = K * v;
    bound = w.norm();
    v = w;
  }
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
