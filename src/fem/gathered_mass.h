#pragma once

/// Masses without those of light corners, for integrators that take no energy.
///
/// The problem: what holds a corner that hardly any material holds fades with its mass (ghost_penalty.h), so its
/// frequency is one that a step resolves, and the energy with which it swings far is next to none. The vibrations of a
/// body that nothing damps come to all its corners alike, so in time each of these has as much energy as any other, and
/// a corner of 1/5000 of a cube swings by eight cubes.
///
/// The method: a corner with less than `light` of a cube's mass gets none. It has no motion of its own then, and
/// follows the others by the balance of elastic forces. What it had goes to the heavy corners of its carrier
/// (grid/carriers.h), as an affine motion would carry it there: with M, X_c and S the mass, centre and second moment of
/// these, the weights
///
///     w_j = m_j (1 / M + (X_j - X_c).S^+ (X - X_c))
///
/// are those that give an affine motion's value at X and change the m_j least. So the body's mass and its centre stay,
/// and its second moments change by the order of h^2, as by lumping. No carrier changes a corner's mass by more than
/// half of it but by its part of what comes in: where it has many light corners on one side, the moment that is left is
/// given to all heavy corners of the piece in the same way.
///
/// `light` is 1/128, a quarter of where the penalty begins to fade. By experiment: a ball of 10 kPa, five cubes a radius,
/// that nobody cuts and that vibrates for a second (Newmark) draws a cube out 30 times with 0, 4.9 times with 1/128, 5.4
/// with 1/32; 50 random bodies under strokes are drawn out as far with 1/128 as with 1/32, within 1 % in the mean. But
/// 1/32 takes the edges of a box of which half a cube is beyond the last node (1/64), and puts the first tone of a bar of
/// eight cubes .56 % off, as much as lumping does; with 1/128 the tone is that of the mass matrix.
///
/// Limits: corners of pieces without a carrier keep their mass.

#include "dynamics/model.h"
#include "grid/solid.h"

#include <span>
#include <vector>

namespace kerf::fem {

struct GatheredMass {
  std::vector<double> mass;                  ///< by corner [kg]
  std::vector<dynamics::Follower> followers; ///< the light corners, carrier by carrier
};

/// `mass` is the lumped one of the material, `mass_of_cube` that of a full cube [kg].
GatheredMass gathered_mass(const grid::Solid& solid, std::span<const double> mass, double mass_of_cube);

} // namespace kerf::fem
