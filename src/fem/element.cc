#include "fem/element.h"

#include <algorithm>

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
  for (int a = 0; a < 8; ++a) {
    // Far from a sliver the integral is below the round-off of its moments, and may come out negative.
    element.mass[a] = mass_of_cube * std::max(0.0, integral_of_shape(moments, a));
    for (int b = 0; b <= a; ++b)
      element.consistent_mass[8 * a + b] = element.consistent_mass[8 * b + a] =
        mass_of_cube * integral_of_product(moments, a, b);
  }
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
  element.gradient = mean_gradients(as_it_lies);
  // The mean gradient is that of the material as it is: so affine motions meet exact forces.
  Matrix24 K = hourglass_stiffness(centred(positive), material, options.strain);
  if (options.part == Part::whole)
    K += mean_stiffness(as_it_lies.volume, element.gradient, material);
  Eigen::Map<Matrix24>(element.stiffness.data()) = 0.5 * h * (K + K.transpose());
  for (Vec3& gradient : element.gradient)
    gradient /= h;
  return element;
}

} // namespace kerf::fem
