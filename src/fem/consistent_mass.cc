#include "fem/consistent_mass.h"

#include "base/parallel.h"

#include <algorithm>

namespace kerf::fem {

namespace {

constexpr std::size_t many_rows = 1024; // corners from which on a second thread pays

Vec3 at(const std::span<const double> values, const std::size_t i) {
  return {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
}

} // namespace

ConsistentMass::ConsistentMass(const ElementTable& elements, const Incidence& incidence,
                               const grid::CornerNumbers& numbers, const double density, const double h)
  : elements_(elements), incidence_(incidence), numbers_(numbers), mass_of_cube_(density * h * h * h) {
  pairs_.push_back(pairs_of(full_cube_moments()));
}

ConsistentMass::Pairs ConsistentMass::pairs_of(const Moments& moments) const {
  const Eigen::Matrix<double, 8, 8> mass = consistent_mass(moments, mass_of_cube_);
  Pairs pairs;
  for (int a = 0; a < 8; ++a)
    for (int b = 0; b <= a; ++b)
      pairs[pair_index(a, b)] = mass(a, b);
  return pairs;
}

void ConsistentMass::update(const grid::Solid& solid, const std::span<const grid::CopyId> changed,
                            const std::span<const double> lumped, const std::span<const double> extended) {
  pairs_of_.resize(solid.complex.n_copies(), 0);
  std::vector<grid::CopyId> partial;
  for (const auto c : changed) {
    if (elements_.is_full(c.value) || !incidence_.is_used(c.value))
      continue;
    partial.push_back(c);
    if (pairs_of_[c.value] == 0) {
      pairs_of_[c.value] = static_cast<std::uint32_t>(pairs_.size());
      pairs_.emplace_back();
    }
  }
  parallel_for(partial.size(), [&](const std::size_t i) {
    pairs_[pairs_of_[partial[i].value]] = pairs_of(elements_.moments(solid, partial[i]));
  });
  kept_.resize(lumped.size());
  for (std::size_t i = 0; i < kept_.size(); ++i)
    kept_[i] = extended[i] < lumped[i] ? extended[i] / lumped[i] : 1;
}

template <class Function>
void ConsistentMass::for_each_neighbour(const std::size_t corner, const Function& f) const {
  for (const std::uint32_t user : incidence_.users(corner)) {
    const std::uint32_t copy = user / 8;
    const int a = static_cast<int>(user % 8);
    const Pairs& mass = pairs_[elements_.is_full(copy) ? 0 : pairs_of_[copy]];
    const std::uint32_t* const corners = incidence_.corners(copy);
    for (int b = 0; b < 8; ++b)
      if (b != a)
        f(numbers_[corners[b]],
          mass[pair_index(std::max(a, b), std::min(a, b))] * std::min(kept_[corner], kept_[corners[b]]));
  }
}

void ConsistentMass::add_product(const std::span<const double> p, const std::span<double> y) const {
  parallel_for(
    numbers_.size(),
    [&](const std::size_t i) {
      const Vec3 here = at(p, i);
      Vec3 sum = Vec3::Zero();
      for_each_neighbour(numbers_.corner(i),
                         [&](const std::uint32_t other, const double mass) { sum += mass * (at(p, other) - here); });
      for (int k = 0; k < 3; ++k)
        y[3 * i + k] += sum[k];
    },
    many_rows);
}

void ConsistentMass::add_entries(const double factor, std::vector<Eigen::Triplet<double>>& entries) const {
  for (std::size_t i = 0; i < numbers_.size(); ++i)
    for_each_neighbour(numbers_.corner(i), [&](const std::uint32_t other, const double mass) {
      for (std::size_t k = 0; k < 3; ++k) {
        entries.emplace_back(3 * i + k, 3 * other + k, factor * mass);
        entries.emplace_back(3 * i + k, 3 * i + k, -factor * mass);
      }
    });
}

} // namespace kerf::fem
