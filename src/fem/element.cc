#include "fem/element.h"

#include <algorithm>

namespace kerf::fem {

namespace {

/// Coefficients of 1, x, x^2.
using Quadratic = std::array<double, 3>;

/// One-dimensional factor of a derivative of N: shape function `node` (0 or 1), differentiated or not.
std::array<double, 2> factor(const int node, const int derivative) {
  if (derivative == 1)
    return {node == 1 ? 1.0 : -1.0, 0.0};
  return node == 1 ? std::array<double, 2>{0.0, 1.0} : std::array<double, 2>{1.0, -1.0};
}

/// Product of two factors; index of (node_a, node_b, derivative_a, derivative_b) is their bits in this order.
std::array<Quadratic, 16> products() {
  std::array<Quadratic, 16> all;
  for (int n = 0; n < 16; ++n) {
    const auto f = factor(n & 1, n >> 2 & 1), g = factor(n >> 1 & 1, n >> 3 & 1);
    all[n] = {f[0] * g[0], f[0] * g[1] + f[1] * g[0], f[1] * g[1]};
  }
  return all;
}

/// Integrals of products of derivatives of shape functions, by contracting the moments one axis at a time.
class ShapeIntegrals {
 public:
  explicit ShapeIntegrals(const Moments& m) {
    std::array<std::array<double, 9>, 16> x{};
    for (int n = 0; n < 16; ++n)
      for (int jk = 0; jk < 9; ++jk)
        for (int i = 0; i < 3; ++i)
          x[n][jk] += products_[n][i] * m[i + 3 * jk];
    for (int n = 0; n < 16; ++n)
      for (int l = 0; l < 16; ++l)
        for (int k = 0; k < 3; ++k) {
          xy_[n][l][k] = 0;
          for (int j = 0; j < 3; ++j)
            xy_[n][l][k] += products_[l][j] * x[n][j + 3 * k];
        }
  }

  /// Integral of N_a,i N_b,j over the material in the unit cube.
  double operator()(const int a, const int i, const int b, const int j) const {
    std::array<int, 3> n;
    for (int axis = 0; axis < 3; ++axis)
      n[axis] = (a >> axis & 1) | (b >> axis & 1) << 1 | (axis == i) << 2 | (axis == j) << 3;
    double sum = 0;
    for (int k = 0; k < 3; ++k)
      sum += products_[n[2]][k] * xy_[n[0]][n[1]][k];
    return sum;
  }

 private:
  std::array<Quadratic, 16> products_ = products();
  std::array<std::array<std::array<double, 3>, 16>, 16> xy_;
};

/// Integral over the material of the product of one linear factor along each axis.
double integrate(const Moments& m, const std::array<std::array<double, 2>, 3>& f) {
  double sum = 0;
  for (int k = 0; k < 2; ++k)
    for (int j = 0; j < 2; ++j)
      for (int i = 0; i < 2; ++i)
        sum += f[0][i] * f[1][j] * f[2][k] * m[i + 3 * j + 9 * k];
  return sum;
}

double integrate_shape(const Moments& m, const int a, const int derivative_axis) {
  std::array<std::array<double, 2>, 3> f;
  for (int axis = 0; axis < 3; ++axis)
    f[axis] = factor(a >> axis & 1, axis == derivative_axis);
  return integrate(m, f);
}

void fill_stiffness(Element& element, const Moments& moments, const double h, const material::Elastic& material) {
  const ShapeIntegrals integral(moments);
  const double lambda = material.lambda(), mu = material.mu();
  for (int a = 0; a < 8; ++a)
    for (int b = a; b < 8; ++b) {
      Mat3 g; // g(i, j) = int N_a,i N_b,j
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          g(i, j) = integral(a, i, b, j);
      const Mat3 block = h * (lambda * g + mu * g.transpose() + mu * g.trace() * Mat3::Identity());
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
          element.stiffness[(3 * a + i) + 24 * (3 * b + j)] = block(i, j);
          element.stiffness[(3 * b + j) + 24 * (3 * a + i)] = block(i, j);
        }
    }
}

} // namespace

Element make_element(const Moments& moments, const double h, const material::Elastic& material,
                     const double sliver_floor) {
  Element element;
  const double fraction = moments[0];
  element.volume = fraction * h * h * h;
  for (int a = 0; a < 8; ++a) {
    // Far from a sliver the integral is below the round-off of its moments, and may come out negative.
    element.mass[a] = material.density * h * h * h * std::max(0.0, integrate_shape(moments, a, -1));
  }
  Moments stiff = moments;
  const double missing = std::max(0.0, sliver_floor - fraction);
  const Moments full = full_cube_moments();
  for (int n = 0; n < 27; ++n)
    stiff[n] += missing * full[n];
  for (int a = 0; a < 8; ++a)
    for (int axis = 0; axis < 3; ++axis)
      element.gradient[a][axis] = integrate_shape(stiff, a, axis) / (stiff[0] * h);
  fill_stiffness(element, stiff, h, material);
  return element;
}

void spread_mass(Element& element, const double part) {
  double total = 0;
  for (const double m : element.mass)
    total += m;
  for (double& m : element.mass)
    m += part * (total / 8 - m);
}

} // namespace kerf::fem
