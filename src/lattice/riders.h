#pragma once

/// Corners of hardly any mass, and what carries them.
///
/// The problem: the force k m (g - x) lets a corner swing about its goal with the frequency sqrt(k) whatever its mass m.
/// What starts that, a cut that moves its goal, has as much energy as m allows: next to none in a corner that only a sliver
/// or a piece of skin knows, opposite to the material. So such corners swing by cubes and at any speed, for ever, in silence.
///
/// The method: a *rider* is a corner with less than m_ref = 1/128 of a cube's mass, half of what the outer corners of a box
/// have along its edges where its skin lies midway; its *carrier* is the nearest copy of the piece (fewest steps between
/// copies with a corner in common) of which at least four corners have 1/32 and more: an eighth of a cube that is a quarter
/// full. (With m_ref = 1/32 a bar of two nodes' thickness bends by 1.4 % more in its tests; 1/512 leaves corners of 4e-3
/// cubes at 5 m/s where 2.3 are allowed, 1/128 those of 2e-2.) In each step the rider's velocity against the carrier's rigid motion
/// is damped, and the carrier takes the impulse at the rider's place as a rigid body does. With alpha = k dt^2 and
/// e = x - g, w = dt v against that motion, a step is
///
///     w' = (1 - kappa) w - alpha e,   e' = e + w',
///
/// of determinant 1 - kappa and trace 2 - kappa - alpha: both eigenvalues are 1 - sqrt(alpha), the critically damped case,
/// for kappa = 2 sqrt(alpha) - alpha. It fades as 1 - m / m_ref, so that a cut that moves on changes nothing abruptly.
///
/// What it keeps: momentum and angular momentum, to round-off; rigid motions, which it does not see; and energy never
/// grows: with sigma the sum over a carrier's riders of m (1 / M + r^2 |I^-1|), M and I its mass and inertia, r the rider's
/// distance from its middle, impulses of kappa m w / (1 + sigma) take more from the riders than they give.
///
/// Limits: pieces without a carrier have no riders; and a carrier that is crushed to a line or to a point carries none.

#include "grid/complex.h"

#include <array>
#include <span>
#include <vector>

namespace kerf::lattice {

class Riders {
 public:
  Riders() = default; ///< none
  /// `mass` of the corners, `mass_of_cube` of a full one [kg].
  Riders(const grid::CellComplex& complex, std::span<const double> mass, double mass_of_cube);

  /// Changes velocities at positions x [m], [m/s] for alpha = k dt^2.
  void damp(const Points& x, std::span<const double> mass, double alpha, Points& v) const;

  std::size_t n_riders() const { return riders_.size(); }

 private:
  struct Rider {
    std::uint32_t corner;
    double need; ///< 1 - m / m_ref [1]
  };
  struct Carrier {
    std::array<std::uint32_t, 8> corners;
    std::uint32_t n_corners;
    std::uint32_t first, last; ///< its riders
  };

  void damp(const Carrier& carrier, const Points& x, std::span<const double> mass, double kappa, Points& v) const;

  std::vector<Carrier> carriers_;
  std::vector<Rider> riders_; ///< carrier by carrier
};

} // namespace kerf::lattice
