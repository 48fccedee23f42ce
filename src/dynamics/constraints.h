#pragma once

/// What supports leave of the corners' motion.
///
/// A support holds each of its corners along the range of a projector H: H (x - place) = 0. A corner in several
/// supports obeys all of them; if some of them hold it in all directions, the last of these alone. With S the sum of
/// its H and c the sum of its H place, it is moved by S^+ (c - S x), which is the least motion that obeys.
///
/// Corners that a rigid body carries (Loads::carried) have no freedom and no place: they stay.

#include "base/loan.h"
#include "dynamics/loads.h"
#include "dynamics/pieces.h"

#include <span>

namespace kerf::dynamics {

/// For which integrators take the velocity of a support at a time, by central differences.
constexpr double part_of_step = 1e-2;

class Constraints {
 public:
  /// The loads must outlive it.
  Constraints(const Loads& loads, std::size_t n_corners);

  /// What is left of a corner. Few corners differ, so these are shared.
  struct Freedom {
    Mat3 sum = Mat3::Zero();         ///< S
    Mat3 inverse = Mat3::Zero();     ///< S^+
    Mat3 basis = Mat3::Identity();   ///< orthonormal columns, the free ones first
    Mat3 project = Mat3::Identity(); ///< onto the free directions
    int n_free = 3;                  ///< directions
  };
  const Freedom& freedom(const std::size_t corner) const { return freedoms_[kind_[corner]]; }
  bool is_free(const std::size_t corner) const { return kind_[corner] == 0; }

  std::size_t n_corners() const { return kind_.size(); }
  /// Components of all corners that are not held.
  std::size_t n_free() const;

  /// Moves held components of x [m] to their places at a time [s].
  void place(double time, Points& x) const;
  /// Gives held components of v [m/s] the velocity of their places at a time [s], by central differences over 2 delta.
  void place_velocity(double time, double delta, Points& v) const;
  /// Leaves of a value a corner only its free part.
  void project(Points& values) const;

  /// One of a corner's supports.
  struct Hold {
    std::uint32_t support, index; ///< in Loads::supports, in its corners
  };
  /// A held corner and its part of the list of holds.
  struct Held {
    std::uint32_t corner, begin, end;
  };
  const std::vector<Held>& held() const { return *held_; }
  /// Of the corners from one to another.
  std::span<const Held> held(std::size_t begin, std::size_t end) const;
  /// What supports want at a time, for each corner of each support, in a row: places [m], velocities [m/s].
  Loan<Vec3> places(double time) const;
  Loan<Vec3> velocities(double time, double delta) const;
  /// Gives that to held components of the values of some corners.
  void impose(const Points& wanted, std::span<const Held> held, Points& values) const;
  /// The supports that a held corner obeys.
  std::span<const Hold> holds(const Held& held) const {
    return std::span<const Hold>(*holds_).subspan(held.begin, held.end - held.begin);
  }

 private:
  void add(std::uint32_t corner, std::span<const Hold> holds);
  void add_carried();
  std::uint32_t kind_of(const Mat3& sum);

  const Loads& loads_;
  Loan<Freedom> freedoms_;
  Loan<std::uint32_t> kind_; // of each corner, in freedoms_
  Loan<Held> held_;          // by ascending corner
  std::size_t n_carried_ = 0;
  Loan<Hold> holds_;
  Loan<std::size_t> first_; // of each support, among the corners of all
};

/// 1 for each piece that supports hold nowhere.
Loan<std::uint8_t> free_pieces(const Pieces& pieces, const Loads& loads, std::size_t n_corners);

} // namespace kerf::dynamics
