#include "physics/widened.h"

#include <algorithm>

namespace kerf::physics {

namespace {

/// 3 numbers a corner, to 3 a number.
Loan<double> gathered(const grid::CornerNumbers& numbers, const std::span<const double> of_corners) {
  Loan<double> of_numbers(3 * numbers.size());
  for (std::size_t i = 0; i < numbers.size(); ++i)
    std::copy_n(of_corners.data() + 3 * std::size_t(numbers.corner(i)), 3, of_numbers->data() + 3 * i);
  return of_numbers;
}

} // namespace

void WidenedCoupling::add_product(const std::span<const double> p, const std::span<double> y) const {
  Loan<double> product(3 * numbers_.size(), 0.0);
  by_number_.add_product(*gathered(numbers_, p), *product);
  for (std::size_t i = 0; i < product.size(); ++i)
    y[3 * std::size_t(numbers_.corner(i / 3)) + i % 3] += product[i];
}

void WidenedCoupling::add_entries(const double factor, std::vector<Eigen::Triplet<double>>& entries) const {
  std::vector<Eigen::Triplet<double>> by_number;
  by_number_.add_entries(factor, by_number);
  const auto component = [&](const int i) { return 3 * static_cast<int>(numbers_.corner(i / 3)) + i % 3; };
  for (const auto& entry : by_number)
    entries.emplace_back(component(entry.row()), component(entry.col()), entry.value());
}

void WidenedElasticModel::apply_stiffness(const std::span<const double> p, const std::span<double> y) const {
  Loan<double> product(3 * numbers_.size());
  by_number_.apply_stiffness(*physics::gathered(numbers_, p), *product);
  std::ranges::fill(y, 0.0);
  for (std::size_t i = 0; i < product.size(); ++i)
    y[3 * std::size_t(numbers_.corner(i / 3)) + i % 3] = product[i];
}

void WidenedElasticModel::stiffness_diagonal(const PutBlock put) const {
  Loan<Mat3> blocks(lumped_mass().size(), Mat3::Zero());
  by_number_.stiffness_diagonal(
    [&](const std::size_t number, const Mat3& block) { blocks[numbers_.corner(number)] = block; });
  for (std::size_t corner = 0; corner < blocks.size(); ++corner)
    put(corner, blocks[corner]);
}

} // namespace kerf::physics
