#pragma once

/// Sums over the pieces of a body, which nothing joins: what one of them does tells nothing about another.

#include "base/loan.h"
#include "base/vec.h"

#include <cstdint>
#include <span>
#include <vector>

namespace kerf::dynamics {

class Pieces {
 public:
  /// The piece of each corner, 0, 1, ...; empty: all are one.
  explicit Pieces(std::vector<std::uint32_t> piece_of_corner = {});

  std::size_t n() const { return n_; }
  std::uint32_t of(const std::size_t corner) const { return piece_.empty() ? 0 : piece_[corner]; }

  /// Of a.b over the corners of each piece.
  Loan<double> products(const Points& a, const Points& b) const;
  /// Values a corner, less their mean by mass over its piece; as they are where `which` is 0.
  Loan<Vec3> without_mean(std::span<const double> mass, const Points& values,
                          std::span<const std::uint8_t> which) const;

 private:
  std::vector<std::uint32_t> piece_;
  std::size_t n_ = 1;
};

} // namespace kerf::dynamics
