#pragma once

/// What integrators ask of a physics. Positions and forces are 3 n numbers, corner by corner.

#include "base/function_ref.h"
#include "base/vec.h"

#include <Eigen/SparseCore>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace kerf::dynamics {

/// What a mass matrix M has beside its lumped masses m: M - diag(m), symmetric, with rows that sum to zero.
class MassCoupling {
 public:
  virtual ~MassCoupling() = default;

  /// y += (M - diag(m)) p.
  virtual void add_product(std::span<const double> p, std::span<double> y) const = 0;
  /// The same times `factor`, as entries of a matrix of 3 n x 3 n.
  virtual void add_entries(double factor, std::vector<Eigen::Triplet<double>>& entries) const = 0;
};

/// A corner without mass: its place follows from the balance of forces, its velocity from those of its leaders, which
/// have a mass (followers.h). The weights are those of affine motions.
struct Follower {
  std::uint32_t corner;
  std::uint32_t n_leaders;
  std::array<std::uint32_t, 8> leaders;
  std::array<double, 8> weights; ///< sum to 1

  Vec3 led(const Points& values) const {
    Vec3 sum = Vec3::Zero();
    for (std::uint32_t k = 0; k < n_leaders; ++k)
      sum += weights[k] * values[leaders[k]];
    return sum;
  }
};

/// Enough for explicit integrators.
class ForceModel {
 public:
  virtual ~ForceModel() = default;

  /// Mass of each corner [kg].
  virtual std::span<const double> lumped_mass() const = 0;
  /// Null where the mass is lumped. Explicit integrators do not ask.
  virtual const MassCoupling* mass_coupling() const { return nullptr; }
  /// None where every corner has a mass, or nothing moves it.
  virtual std::span<const Follower> followers() const { return {}; }
  /// Elastic energy [J] at current positions x [m].
  virtual double energy(const Points& x) const = 0;
  /// The same, where forces are wanted next: a model may find them on the way, and keep them for force().
  virtual double energy_ahead(const Points& x) const { return energy(x); }
  /// forces = -dE/dx [N].
  virtual void force(const Points& x, Points& forces) const = 0;
};

class Preconditioner;
struct LinearEquation;

/// What implicit integrators ask beside it: a symmetric, positive semi-definite stiffness at a linearisation point.
class ElasticModel : public ForceModel {
 public:
  /// Takes x [m] as the point at which the next two are meant.
  virtual void linearise(const Points& x) = 0;
  /// y = K p [N] for p [m].
  virtual void apply_stiffness(std::span<const double> p, std::span<double> y) const = 0;
  /// Calls put(corner, block) with the diagonal 3 x 3 block of K at each corner [N/m], several at a time.
  using PutBlock = FunctionRef<void(std::size_t corner, const Mat3& block)>;
  virtual void stiffness_diagonal(PutBlock put) const = 0;
  /// An approximate inverse (preconditioner.h) at the linearisation point, good until the next one; null where the
  /// inverse of the equation's diagonal blocks is as good.
  virtual Preconditioner* preconditioner(const LinearEquation&) { return nullptr; }
};

/// The diagonal 3 x 3 blocks of K [N/m], one a corner.
inline std::vector<Mat3> stiffness_blocks(const ElasticModel& model) {
  std::vector<Mat3> blocks(model.lumped_mass().size());
  model.stiffness_diagonal([&](const std::size_t corner, const Mat3& block) { blocks[corner] = block; });
  return blocks;
}

/// Which derivative of the forces.
enum class Tangent {
  positive, ///< symmetric and positive semi-definite: conjugate gradients and descent are safe
  exact     ///< the derivative itself: Newton's method converges quadratically
};

/// What a direct solver asks; a model may offer it beside ElasticModel.
class StiffnessMatrix {
 public:
  virtual ~StiffnessMatrix() = default;

  /// K [N/m] at x [m], 3 n x 3 n, both triangles.
  virtual Eigen::SparseMatrix<double> stiffness_matrix(const Points& x, Tangent kind) const = 0;
};

} // namespace kerf::dynamics
