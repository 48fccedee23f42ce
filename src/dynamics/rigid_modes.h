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

/// Throws ParameterError that names them when there are any.
void require_supported(const std::vector<FreeMode>& modes);

} // namespace kerf::dynamics
