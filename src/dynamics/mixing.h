#pragma once

/// Anderson's mixing (1965, Iterative procedures for nonlinear integral equations, J. ACM 12): corrections d of the
/// last iterates x tell how d changes with x, and so where it vanishes, as far as the iterates have been. Newton's
/// method with a tangent that is not the exact one converges linearly; mixed, it needs about as many iterations as its
/// errors have slow directions.

#include "base/loan.h"
#include "base/vec.h"

#include <array>
#include <cstddef>
#include <span>

namespace kerf::dynamics {

class Mixing {
 public:
  static constexpr std::size_t most = 8;

  /// `depth`: corrections before that count, `most` at most.
  explicit Mixing(const std::size_t depth) : depth_(depth) {}

  /// Makes the plain correction d at x the mixed one, by those before; least squares weigh corners by `weight` [any
  /// unit]. Where there are none before, it stays.
  void mix(const Points& x, std::span<const double> weight, Points& d);
  void forget() { n_past_ = 0; }

 private:
  struct Change {
    Loan<Vec3> x = Loan<Vec3>::none(), d = Loan<Vec3>::none(); ///< between iterates
  };

  std::size_t depth_, n_past_ = 0;
  std::array<Change, most> past_;
  Change last_; // iterate and its correction
};

} // namespace kerf::dynamics
