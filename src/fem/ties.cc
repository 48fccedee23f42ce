#include "fem/ties.h"

#include <cmath>

namespace kerf::fem {

namespace {

Eigen::Map<const Vec3> at(const std::span<const double> values, const std::uint32_t corner) {
  return Eigen::Map<const Vec3>(values.data() + 3 * std::size_t(corner));
}
Eigen::Map<Vec3> at(const std::span<double> values, const std::uint32_t corner) {
  return Eigen::Map<Vec3>(values.data() + 3 * std::size_t(corner));
}

} // namespace

void Ties::update(const grid::Solid& solid, const material::Elastic& material, const std::span<const double> mass) {
  const double nu = material.poissons_ratio, modulus = material.youngs_modulus / (1 - nu * nu);
  std::vector<grid::Tie> ties = grid::ties(solid);
  if (!mass.empty())
    grid::soften(ties, modulus, 2 * std::pow(material.pressure_wave_speed() / solid.grid.h(), 2),
                 [&](const grid::CornerId c) { return mass[c.value]; });
  ties_.clear();
  for (const grid::Tie& tie : ties)
    ties_.push_back({tie.a.value, tie.b.value, modulus * tie.length});
}

void Ties::count_by(const grid::CornerNumbers& numbers) {
  for (Tie& tie : ties_) {
    tie.a = numbers[tie.a];
    tie.b = numbers[tie.b];
  }
}

double Ties::energy(const Points& x) const {
  double sum = 0;
  for (const auto& [a, b, k] : ties_)
    sum += 0.5 * k * (x[a] - x[b]).squaredNorm();
  return sum;
}

void Ties::add_energies(const Points& x, const dynamics::Pieces& pieces, const std::span<double> sums) const {
  for (const auto& [a, b, k] : ties_)
    sums[pieces.of(a)] += 0.5 * k * (x[a] - x[b]).squaredNorm();
}

void Ties::add_force(const Points& x, Points& forces) const {
  for (const auto& [a, b, k] : ties_) {
    const Vec3 f = k * (x[a] - x[b]);
    forces[a] -= f;
    forces[b] += f;
  }
}

void Ties::add_product(const std::span<const double> p, const std::span<double> y) const {
  for (const auto& [a, b, k] : ties_) {
    const Vec3 f = k * (at(p, a) - at(p, b));
    at(y, a) += f;
    at(y, b) -= f;
  }
}

void Ties::add_diagonal(const std::span<double> diagonal) const {
  for (const auto& [a, b, k] : ties_) {
    diagonal[a] += k;
    diagonal[b] += k;
  }
}

void Ties::add_entries(std::vector<Eigen::Triplet<double>>& entries) const {
  for (const auto& [a, b, stiffness] : ties_)
    for (int k = 0; k < 3; ++k) {
      entries.emplace_back(3 * a + k, 3 * a + k, stiffness);
      entries.emplace_back(3 * b + k, 3 * b + k, stiffness);
      entries.emplace_back(3 * a + k, 3 * b + k, -stiffness);
      entries.emplace_back(3 * b + k, 3 * a + k, -stiffness);
    }
}

} // namespace kerf::fem
