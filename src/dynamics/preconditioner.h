#pragma once

/// The contract of an approximate inverse that a model makes of its own linear equations.

#include "dynamics/constraints.h"
#include "dynamics/load.h"

#include <cstddef>
#include <span>

namespace kerf::dynamics {

/// A = mass_factor M + stiffness_factor K + loads, among the directions that supports leave free, with K at the model's
/// linearisation point.
struct LinearEquation {
  double mass_factor, stiffness_factor; ///< [1/s^2], [1]
  std::span<const double> mass;         ///< of each corner [kg]
  double trace;                         ///< of A [N/m]
  const LoadTangent& loads;             ///< what loads add to A, among all directions
  const Constraints& constraints;
};

/// C^T C, a part of A that is much stiffer than the rest, as what a nearly incompressible body has against changes of
/// volume. C has a row for each of its constraints.
class StiffPart {
 public:
  virtual ~StiffPart() = default;

  virtual std::size_t n_rows() const = 0;
  /// q = C p.
  virtual void product(std::span<const double> p, std::span<double> q) const = 0;
  /// y += C^T q.
  virtual void add_transposed(std::span<const double> q, std::span<double> y) const = 0;
  /// About the largest eigenvalue of C R^-1 C^T with R = A - C^T C, what remains [1].
  virtual double excess() const = 0;
};

class Preconditioner {
 public:
  virtual ~Preconditioner() = default;

  /// z = B r [m] for r [N], 3 n numbers each, with B near A^-1: symmetric, and positive among the free directions. What
  /// r has along others is not looked at, and z has none there.
  virtual void apply(std::span<const double> r, std::span<double> z) = 0;
  /// What of A it leaves out, which it may in statics alone (mass_factor 0): then B is near the inverse of what remains,
  /// and solve_equation() of minimal_residuals.h is for that. Null: nothing.
  virtual const StiffPart* stiff_part() const { return nullptr; }
};

/// L^-1 for the Cholesky factor L of a diagonal block among its free directions, from whose basis it maps; zero rows
/// for those that are held. So S^T S is the block's inverse.
Mat3 inverse_factor(const Mat3& block, const Constraints::Freedom& freedom);
/// The same in single precision; of blocks that are too narrow for it, found in double.
Eigen::Matrix3f inverse_factor_in_single(const Mat3& block, const Constraints::Freedom& freedom);

} // namespace kerf::dynamics
