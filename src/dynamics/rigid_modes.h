#pragma once

/// The rigid motions of a body's pieces that nothing resists: statics has no answer while there is one.
///
/// A piece has six, t + r x (x - c) with c its centre of mass. On them the supports (1 for each held direction of each
/// corner) and the stiffness of the loads (handles, a floor that is touched) make a 6 x 6 matrix whose kernel is free.
/// What moves no corner is no mode: a straight row of masses does not turn about itself.

#include "dynamics/constraints.h"

#include <span>

namespace kerf::dynamics {

struct FreeMode {
  std::uint32_t piece = 0;
  Vec3 centre, translation, rotation; ///< c [m]; t and r, of any size
  std::string name;                   ///< "translation along x", "rotation about z", or an axis in numbers
};

/// `piece` of each corner, 0, 1, ...; empty: one piece. At positions x [m] and a time [s].
std::vector<FreeMode> free_rigid_modes(const ForceModel& model, const Loads& loads, double time, const Points& x,
                                       std::span<const std::uint32_t> piece);

/// Rigid motions that an equation leaves out. Along them bodies are accelerated as a whole by what their loads have out
/// of balance, and deform in the frame that is: forces are relieved of as much as the masses' inertia takes (inertia
/// relief), and motions of as much as the masses move along them.
class FreeMotions {
 public:
  FreeMotions() = default; ///< none
  /// `piece` of each corner (empty: one piece), its mass [kg], and its place where the modes are meant [m].
  FreeMotions(const std::vector<FreeMode>& modes, std::span<const std::uint32_t> piece, std::span<const double> mass,
              const Points& x);

  bool any() const { return !motions_.empty(); }
  std::size_t size() const { return motions_.size(); }
  void relieve_forces(std::span<double> forces) const;
  void relieve_motion(std::span<double> d) const;
  /// What forces along a motion have out of balance, over what they are one by one [1].
  double part_out_of_balance(std::size_t motion, const Points& forces) const;

 private:
  /// Of the corners of one piece. All of a piece are orthonormal as measured by mass.
  struct Motion {
    std::vector<std::uint32_t> corners;
    Points d;
  };
  std::vector<double> mass_;
  std::vector<Motion> motions_;
};

/// Throws ParameterError that names them when there are any.
void require_supported(const std::vector<FreeMode>& modes);

} // namespace kerf::dynamics
