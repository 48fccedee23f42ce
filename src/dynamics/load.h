#pragma once

/// The contract of a force from outside that depends on time, positions and velocities.

#include "base/interpolation.h"
#include "dynamics/model.h"

#include <Eigen/SparseCore>

namespace kerf::dynamics {

/// Where and how a body is at one time. Refers to points that must outlive it.
struct Moment {
  double time;     ///< [s]
  const Points& x; ///< corner positions [m]
  const Points& v; ///< corner velocities [m/s]
};

/// Derivatives of the forces of loads by the corners, with the sign of a stiffness: a sum of W_i^T B W_j.
class LoadTangent {
 public:
  /// A force -B W_j p at point i for a displacement p of the corners. `points` must outlive this.
  void add(const Interpolation& points, std::size_t i, std::size_t j, const Mat3& B) {
    terms_.push_back({&points, i, j, B});
  }
  /// What another one says, for corners that have other numbers here: `numbers` by corner, which must outlive this.
  /// Corners whose number is `uncounted` do not move.
  void add(const LoadTangent& by_corner, std::span<const std::uint32_t> numbers);
  static constexpr std::uint32_t uncounted = 0xffffffff;

  bool empty() const { return terms_.empty(); }
  /// y += K p, in 3 n numbers.
  void add_product(std::span<const double> p, std::span<double> y) const;
  /// Adds the symmetric part of the diagonal 3 x 3 blocks.
  void add_diagonal(std::vector<Mat3>& blocks) const;
  /// For each term of one point calls add(corner, weight) for its corners, then end(block) with its symmetric part.
  template <class Add, class End>
  void for_each_point(const Add& add, const End& end) const {
    for (const Term& term : terms_)
      if (term.i == term.j) {
        term.for_each_corner(term.i, add);
        end(Mat3(0.5 * (term.block + term.block.transpose())));
      }
  }
  /// Adds blocks that together are at least what the terms of two points are.
  void add_bound_of_pairs(std::vector<Mat3>& blocks) const;
  /// All entries, by the numbers of the 3 n components.
  void add_entries(std::vector<Eigen::Triplet<double>>& entries) const;

 private:
  struct Term {
    const Interpolation* points;
    std::size_t i, j;
    Mat3 block;
    const std::uint32_t* numbers = nullptr; ///< of the corners; null: their own

    /// Calls f(corner, weight).
    template <class Function>
    void for_each_corner(const std::size_t point, const Function& f) const {
      for (auto k = points->start[point]; k < points->start[point + 1]; ++k) {
        const std::uint32_t corner = numbers ? numbers[points->columns[k]] : points->columns[k];
        if (corner != uncounted)
          f(corner, points->values[k]);
      }
    }
  };
  std::vector<Term> terms_;
};

/// What the work of a load is booked as.
enum class Nature {
  conservative, ///< has a potential, at each fixed time
  driving,      ///< does work that no potential gives back
  dissipative   ///< only ever takes energy
};

class Load {
 public:
  virtual ~Load() = default;

  virtual Nature nature() const = 0;
  /// Potential energy [J]; 0 unless conservative.
  virtual double energy(double time, const Points& x) const = 0;
  /// Adds the forces on the corners [N].
  virtual void add_force(const Moment& moment, Points& forces) const = 0;
  /// Adds -df/dx - velocity_factor df/dv [N/m], velocity_factor in 1/s: what an integrator with dv = velocity_factor dx
  /// sees. Tangent::positive leaves out what would make it unsymmetric or indefinite.
  virtual void add_tangent(Tangent kind, const Moment& moment, double velocity_factor, LoadTangent& tangent) const = 0;
  /// Is its force bounded, however fast a body moves? Then explicit steps that are too long for its slope at rest make
  /// the body quiver, and no more.
  virtual bool is_bounded_in_velocity() const { return false; }
};

} // namespace kerf::dynamics
