#include "dynamics/load.h"

#include <cmath>

namespace kerf::dynamics {

void LoadTangent::add(const LoadTangent& by_corner, const std::span<const std::uint32_t> numbers) {
  for (Term term : by_corner.terms_) {
    term.numbers = numbers.data();
    bool moves = false;
    for (const auto point : {term.i, term.j})
      term.for_each_corner(point, [&](std::uint32_t, double) { moves = true; });
    if (moves)
      terms_.push_back(term);
  }
}

void LoadTangent::add_product(const std::span<const double> p, const std::span<double> y) const {
  for (const Term& term : terms_) {
    Vec3 at_j = Vec3::Zero();
    term.for_each_corner(term.j, [&](const std::uint32_t corner, const double weight) {
      at_j += weight * Eigen::Map<const Vec3>(p.data() + 3 * std::size_t(corner));
    });
    const Vec3 at_i = term.block * at_j;
    term.for_each_corner(term.i, [&](const std::uint32_t corner, const double weight) {
      Eigen::Map<Vec3>(y.data() + 3 * std::size_t(corner)) += weight * at_i;
    });
  }
}

void LoadTangent::add_diagonal(std::vector<Mat3>& blocks) const {
  for (const Term& term : terms_) {
    const Mat3 symmetric = 0.5 * (term.block + term.block.transpose());
    term.for_each_corner(term.i, [&](const std::uint32_t c, const double of_c) {
      term.for_each_corner(term.j, [&](const std::uint32_t d, const double of_d) {
        if (c == d)
          blocks[c] += of_c * of_d * symmetric;
      });
    });
  }
}

/// |sum w_k p_k|^2 <= sum |w_l| sum |w_k| |p_k|^2; a pair is bounded by the size of its block at both.
void LoadTangent::add_bound_of_pairs(std::vector<Mat3>& blocks) const {
  for (const Term& term : terms_) {
    if (term.i == term.j)
      continue;
    double sum = 0;
    term.for_each_corner(term.i, [&](std::uint32_t, const double weight) { sum += std::abs(weight); });
    const double size = 0.5 * (term.block + term.block.transpose()).norm();
    term.for_each_corner(term.i, [&](const std::uint32_t corner, const double weight) {
      blocks[corner] += sum * std::abs(weight) * size * Mat3::Identity();
    });
  }
}

void LoadTangent::add_entries(std::vector<Eigen::Triplet<double>>& entries) const {
  for (const Term& term : terms_)
    term.for_each_corner(term.i, [&](const std::uint32_t c, const double of_c) {
      term.for_each_corner(term.j, [&](const std::uint32_t d, const double of_d) {
        for (int a = 0; a < 3; ++a)
          for (int b = 0; b < 3; ++b)
            if (term.block(a, b) != 0)
              entries.emplace_back(3 * c + a, 3 * d + b, of_c * of_d * term.block(a, b));
      });
    });
}

} // namespace kerf::dynamics
