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
  /// Takes from values a corner their mean by mass over its piece, where `which` is not 0.
  void take_out_mean(std::span<const double> mass, std::span<const std::uint8_t> which, Points& values) const;

 private:
  std::vector<std::uint32_t> piece_;
  std::size_t n_ = 1;
};

} // namespace kerf::dynamics
