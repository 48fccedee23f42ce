#include "fem/coarse_elements.h"

#include <array>
#include <bit>

namespace kerf::fem {

namespace {

using GradientsOfModes = std::array<Vec3, 4>; // of the hourglass modes

/// How much of a child's mode n a coarse mode m is, by octant, m, n.
using PartsOfModes = std::array<std::array<std::array<double, 8>, 8>, 8>;
constexpr PartsOfModes parts_of_modes() {
  PartsOfModes parts{};
  for (unsigned octant = 0; octant < 8; ++octant)
    for (unsigned m = 0; m < 8; ++m)
      for (unsigned n = 0; n < 8; ++n)
        if ((n & ~m) == 0)
          parts[octant][m][n] = (std::popcount(m & ~n & ~octant) % 2 != 0 ? -1.0 : 1.0) / (1 << std::popcount(m));
  return parts;
}
constexpr PartsOfModes parts = parts_of_modes();

/// Adds V (lambda g_m,i g_n,j + mu (delta_ij g_m . g_n + g_m,j g_n,i)).
void add_mean_part(const double volume, const GradientsOfModes& g, const material::Elastic& material,
                   MatrixOfModes& K) {
  const double lambda = volume * material.lambda(), mu = volume * material.mu();
  for (int m = 0; m < 4; ++m)
    for (int n = 0; n < 4; ++n)
      K.block<3, 3>(3 * m, 3 * n) +=
        lambda * g[m] * g[n].transpose() + mu * g[n] * g[m].transpose() + mu * g[m].dot(g[n]) * Mat3::Identity();
}

/// T^T K T for the parts T of the coarse hourglass modes in those of the child.
void add_hourglass_part(const Child& child, MatrixOfModes& K) {
  const auto& packed = child.element->hourglass;
  const auto& of_octant = parts[child.octant];
  const auto block = [&](const int k, const int l) {
    Mat3 B;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        const int p = 3 * k + i, q = 3 * l + j;
        B(i, j) = packed[p > q ? pair_index(p, q) : pair_index(q, p)];
      }
    return B;
  };
  for (int k = 0; k < 4; ++k)
    for (int l = 0; l < 4; ++l) {
      const Mat3 B = block(k, l);
      for (int m = 0; m < 4; ++m)
        for (int n = 0; n < 4; ++n) {
          const double part =
            of_octant[hourglass_modes[m]][hourglass_modes[k]] * of_octant[hourglass_modes[n]][hourglass_modes[l]];
          if (part != 0)
            K.block<3, 3>(3 * m, 3 * n) += part * B;
        }
    }
}

GradientsOfModes gradients_in(const Child& child, const double h) {
  GradientsOfModes g;
  const auto& of_octant = parts[child.octant];
  for (int m = 0; m < 4; ++m) {
    for (int k = 0; k < 3; ++k)
      g[m][k] = of_octant[hourglass_modes[m]][linear_modes[k]] / (4 * h);
    for (int n = 0; n < 4; ++n)
      g[m] += of_octant[hourglass_modes[m]][hourglass_modes[n]] * child.element->mode_gradient[n];
  }
  return g;
}

} // namespace

Element coarse_element(const std::span<const Child> children, const double h, const material::Elastic& material) {
  Element coarse{};
  MatrixOfModes K = MatrixOfModes::Zero();
  GradientsOfModes mean = {Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
  for (const Child& child : children) {
    const GradientsOfModes g = gradients_in(child, h);
    const double volume = child.element->volume;
    add_hourglass_part(child, K);
    add_mean_part(volume, g, material, K);
    coarse.volume += volume;
    for (int m = 0; m < 4; ++m)
      mean[m] += volume * g[m];
  }
  for (Vec3& g : mean)
    g /= coarse.volume;
  add_mean_part(-coarse.volume, mean, material, K);
  coarse.mode_gradient = mean;
  coarse.slope = 1 / (8 * h);
  for (int p = 0; p < n_hourglass; ++p)
    for (int q = 0; q <= p; ++q)
      coarse.hourglass[pair_index(p, q)] = static_cast<float>(0.5 * (K(p, q) + K(q, p)));
  coarse.bound = jacobi_bound(coarse, material);
  return coarse;
}

} // namespace kerf::fem
