#pragma once

/// What integrators ask of a physics. Positions and forces are 3 n numbers, corner by corner.

#include "base/vec.h"

#include <span>
#include <vector>

namespace kerf::dynamics {

/// Enough for explicit integrators.
class ForceModel {
 public:
  virtual ~ForceModel() = default;

  /// Mass of each corner [kg].
  virtual std::span<const double> lumped_mass() const = 0;
  /// Elastic energy [J] at current positions x [m].
  virtual double energy(const Points& x) const = 0;
  /// forces = -dE/dx [N].
  virtual void force(const Points& x, Points& forces) const = 0;
};

/// What implicit integrators ask beside it: a symmetric, positive semi-definite stiffness at a linearisation point.
class ElasticModel : public ForceModel {
 public:
  /// Takes x [m] as the point at which the next two are meant.
  virtual void linearise(const Points& x) = 0;
  /// y = K p [N] for p [m].
  virtual void apply_stiffness(std::span<const double> p, std::span<double> y) const = 0;
  /// The diagonal 3 x 3 blocks of K [N/m], one a corner.
  virtual void stiffness_diagonal(std::vector<Mat3>& blocks) const = 0;
};

} // namespace kerf::dynamics
