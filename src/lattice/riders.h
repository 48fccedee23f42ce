#pragma once

/// Corners of hardly any mass, and what carries them.
///
/// The problem: the force k m (g - x) lets a corner swing about its goal with the frequency sqrt(k) whatever its mass
/// m. What starts that, a cut that moves its goal by up to a cube, has as much energy as m allows: next to none in a
/// corner that only a sliver or a piece of skin knows, opposite to the material. So such corners swing by cubes and at
/// any speed, for ever, in silence.
///
/// The method: a *rider* is a corner with less mass than m_ref, a cube that is grid::well_filled; its *carrier* is the
/// nearest copy of the piece (fewest steps between copies with a corner in common) of which at least four corners have
/// 1/32 of a cube and more, an eighth of that: their part of such a cube.
///
/// 1. After a cut a rider *settles*: it is put where its regions now have it, at its goal, and keeps its velocity. Its
///    carrier is moved and turned back by what that takes of the masses' centre and of angular momentum.
/// 2. In each step the rider's velocity against the carrier's rigid motion is damped, and the carrier takes the
///    impulse at the rider's place as a rigid body does. With alpha = k dt^2 and e = x - g, w = dt v against that
///    motion, a step is
///
///     w' = (1 - kappa) w - alpha e,   e' = e + w',
///
/// of determinant 1 - kappa and trace 2 - kappa - alpha: both eigenvalues are 1 - sqrt(alpha), the critically damped
/// case, for kappa = 2 sqrt(alpha) - alpha. Both fade as 1 - m / m_ref, so that a cut that moves on changes nothing
/// abruptly.
///
/// By experiment (11 scenes in which corners ran away): damping alone with m_ref = 1/128 leaves corners of up to .07
/// cubes that swing after a cut at 1.0 to 1.8 times the speed allowed, and settling with it alone 9 of the 11; a
/// reference of the carrier's affine motion instead of its rigid one lets the lightest corners run away by
/// extrapolation.
///
/// Riders of elements are held by them, up to what little stiffness their mass allows (fem/ghost_penalty.h), and what
/// they share of the carrier's vibration is sound: they have *slack*. They are damped by how far they are from where the
/// carrier's rotation has them: not at all within half a cube, wholly from a cube on.
///
/// What they keep: momentum, angular momentum and the masses' centre, to round-off; rigid motions, which they do not
/// see. Damping is implicit, so it never adds energy and each rider gets all of its own, however far out it is: what is
/// left to it is 1 - kappa of its velocity against the carrier's motion after all have given theirs, the solution of six
/// equations. (While impulses were divided by what kept such steps from giving energy, riders far out got a sixth of it.)
///
/// A rider with slack has less than 1/32, so it carries none. By experiment (a rotor of 2 kPa that swings and is cut,
/// symplectic Euler and velocity Verlet): with carriers of 1/256, 1/128, 1/64 and 1/32 copies are drawn out up to 21 and
/// more than 32, 5.5 and 12, 7.4 and 9.7, 5.4 and 6.0 times (implicit Euler 5.2): light ones spin, and far out that is
/// fast. Without slack for riders more than 1.7 cubes from the carrier's middle a box that vibrates loses a third of its
/// energy to them, for 5 %, and in a turbine that several blades cut steps of half the stable one gain energy.
///
/// Limits: pieces without a carrier have no riders; and a carrier that is crushed to a line or to a point carries none.

#include "grid/complex.h"
#include "grid/corner_numbers.h"
#include "grid/crumbs.h"

#include <array>
#include <span>
#include <vector>

namespace kerf::lattice {

class Riders {
 public:
  Riders() = default; ///< none
  /// `mass` of the corners, `mass_of_cube` of a full one [kg]; `light`: m_ref over that of a cube [1].
  Riders(const grid::CellComplex& complex, std::span<const double> mass, double mass_of_cube,
         double light = grid::well_filled);

  /// Riders with slack, for cubes of edge h [m] and corners at rest [m]. Their carriers have five of the corners above,
  /// which no plane holds.
  Riders(const grid::CellComplex& complex, std::span<const double> mass, double mass_of_cube, double light,
         const Points& rest, double h);

  /// Counts corners by these numbers from now on. Those that carry have one; what has none rides no more.
  void count_by(const grid::CornerNumbers& numbers);

  /// Moves riders to goals [m], in x [m] and v [m/s].
  void settle(const Points& goals, std::span<const double> mass, Points& x, Points& v) const;
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

    std::span<const std::uint32_t> own_corners() const { return {corners.data(), n_corners}; }
  };
  std::span<const Rider> riders_of(const Carrier& c) const { return {riders_.data() + c.first, c.last - c.first}; }
  using Slopes = std::array<Vec3, 8>; ///< sum of x_k slopes[k]^T is a carrier's deformation gradient [1/m]
  struct Place {
    Vec3 middle;
    Mat3 rotation;
  };
  /// Of a carrier, for riders with slack.
  Place place(std::size_t carrier, const Points& x) const;
  /// The part of its damping that a rider gets [1].
  double part(const Place& carrier, std::size_t rider, const Points& x) const;

  void ride(const grid::CellComplex& complex, std::span<const double> mass, double mass_of_cube, double light,
            int n_heavy);

  void settle(const Carrier& carrier, const Points& goals, std::span<const double> mass, Points& x, Points& v) const;
  void damp(std::size_t carrier, const Points& x, std::span<const double> mass, double kappa, Points& v) const;

  std::vector<Carrier> carriers_;
  std::vector<Rider> riders_;  ///< carrier by carrier
  double h_ = 0;               ///< edge of the cubes; 0: no slack [m]
  std::vector<Slopes> slopes_; ///< by carrier
  std::vector<Vec3> offsets_;  ///< by rider, from its carrier's middle at rest [m]
};

} // namespace kerf::lattice
