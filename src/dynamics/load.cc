#include "dynamics/load.h"

#include <cmath>

namespace kerf::dynamics {

void LoadTangent::add_product(const std::span<const double> p, const std::span<double> y) const {
  for (const Term& term : terms_) {
    const Interpolation& w = *term.points;
    Vec3 at_j = Vec3::Zero();
    for (auto k = w.start[term.j]; k < w.start[term.j + 1]; ++k)
      at_j += w.values[k] * Eigen::Map<const Vec3>(p.data() + 3 * std::size_t(w.corners[k]));
    const Vec3 at_i = term.block * at_j;
    for (auto k = w.start[term.i]; k < w.start[term.i + 1]; ++k)
      Eigen::Map<Vec3>(y.data() + 3 * std::size_t(w.corners[k])) += w.values[k] * at_i;
  }
}

void LoadTangent::add_diagonal(std::vector<Mat3>& blocks) const {
  for (const Term& term : terms_) {
    const Interpolation& w = *term.points;
    const Mat3 symmetric = 0.5 * (term.block + term.block.transpose());
    for (auto k = w.start[term.i]; k < w.start[term.i + 1]; ++k)
      for (auto l = w.start[term.j]; l < w.start[term.j + 1]; ++l)
        if (w.corners[k] == w.corners[l])
          blocks[w.corners[k]] += w.values[k] * w.values[l] * symmetric;
  }
}

/// |sum w_k p_k|^2 <= sum |w_l| sum |w_k| |p_k|^2; a pair is bounded by the size of its block at both.
void LoadTangent::add_bound_of_pairs(std::vector<Mat3>& blocks) const {
  for (const Term& term : terms_) {
    if (term.i == term.j)
      continue;
    const Interpolation& w = *term.points;
    double sum = 0;
    for (auto k = w.start[term.i]; k < w.start[term.i + 1]; ++k)
      sum += std::abs(w.values[k]);
    const double size = 0.5 * (term.block + term.block.transpose()).norm();
    for (auto k = w.start[term.i]; k < w.start[term.i + 1]; ++k)
      blocks[w.corners[k]] += sum * std::abs(w.values[k]) * size * Mat3::Identity();
  }
}

void LoadTangent::add_entries(std::vector<Eigen::Triplet<double>>& entries) const {
  for (const Term& term : terms_) {
    const Interpolation& w = *term.points;
    for (auto k = w.start[term.i]; k < w.start[term.i + 1]; ++k)
      for (auto l = w.start[term.j]; l < w.start[term.j + 1]; ++l)
        for (int a = 0; a < 3; ++a)
          for (int b = 0; b < 3; ++b)
            if (term.block(a, b) != 0)
              entries.emplace_back(3 * w.corners[k] + a, 3 * w.corners[l] + b,
                                   w.values[k] * w.values[l] * term.block(a, b));
  }
}

} // namespace kerf::dynamics
