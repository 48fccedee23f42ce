#pragma once

/// Anderson's mixing (1965, Iterative procedures for nonlinear integral equations, J. ACM 12): corrections d of the last
/// iterates x tell how d changes with x, and so where it vanishes, as far as the iterates have been. Newton's method with
/// a tangent that is not the exact one converges linearly; mixed, it needs about as many iterations as its errors have
/// slow directions.

#include "base/vec.h"

#include <cstddef>
#include <span>
#include <vector>

namespace kerf::dynamics {

class Mixing {
 public:
  explicit Mixing(const std::size_t depth) : depth_(depth) {}

  /// The mixed correction at x, from the plain one d there and those before; least squares weigh corners by `weight`
  /// [any unit]. The plain one as long as there are none before.
  Points mixed(const Points& x, const Points& d, std::span<const double> weight);
  void forget() { past_.clear(); }

 private:
  struct Change {
    Points x, d; ///< between iterates
  };

  std::size_t depth_;
  std::vector<Change> past_; // few
  Points last_x_, last_d_;
};

} // namespace kerf::dynamics
