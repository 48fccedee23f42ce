#pragma once

/// Lattice shape matching as a potential (Rivers and James 2007; thesis §5.1).
///
/// Each region r (lines.h) is matched by the rigid motion T_r X = R_r (X - X_r) + x_r that fits its corners best, in
/// least squares weighted by mass. What is left over is the energy
///
///     E(x) = k/2 sum over r, c of m_rc |x_c - T_r X_c|^2,
///
/// with m_rc the mass of corner c in region r. Of the mass of corner c, s_cn belongs to node n (shares.h); regions are
/// made of nodes; and what lies in N_n regions counts 1 / N_n in each: m_rc = sum over the nodes n in r of s_cn / N_n.
/// So the sum over r of m_rc is the corner's mass m_c, and since x_r and R_r minimise E,
///
///     f_c = -dE/dx_c = k m_c (g_c - x_c),    g_c = sum over r of (m_rc / m_c) T_r X_c:
///
/// exactly the pull of Rivers and James towards the mean g of the regions' goals, whose alpha is k dt^2. Forces sum to
/// zero, and so do torques, piece by piece. Departs from Rivers and James: their particles are points with their own
/// mass; here a region matches the material inside the cut, whose corners may lie outside of it.
///
/// Cost: linear in corners, independent of w. Rotations are found from the positions alone, not from those of the step
/// before: a model made again after a cut or a restart gives the same bits.
///
/// Limits: k stands for a stiffness only through the size of the regions (calibration.h); lateral contraction is none
/// (nu = 0); where regions are inverted the direction of least extent is taken as the inverted one, so folds that are
/// as long as a region may hold each other.

#include "base/sparse_rows.h"
#include "dynamics/model.h"
#include "grid/corner_numbers.h"
#include "lattice/lines.h"
#include "lattice/riders.h"
#include "lattice/shares.h"

namespace kerf::lattice {

struct MatchingOptions {
  double density = 1000;   ///< [kg/m^3]
  int half_width = 2;      ///< of the regions, in cubes; more than the body has is no error [1]
  double stiffness = 3600; ///< k, the square of the frequency of a corner that alone is off its goal [1/s^2]
  grid::Counted counted = grid::Counted::all; ///< corners that integrators see
};

class Matching : public dynamics::ForceModel {
 public:
  /// Throws ParameterError for an option that makes no sense.
  Matching(const grid::Solid& solid, const MatchingOptions& options);

  /// Corners as integrators see them: all that they give and get is by number.
  const grid::CornerNumbers& numbers() const { return numbers_; }

  std::span<const double> lumped_mass() const override { return mass_; }
  /// Round-off is that of k sum of m_c |x_c|^2 from the body's middle.
  double energy(const Points& x) const override;
  void force(const Points& x, Points& forces) const override;

  /// g at current positions x [m].
  void goals(const Points& x, Points& g) const;
  /// For each corner the mean of the rigid velocities that fit its regions' momentum and angular momentum at x: sums of
  /// both over the corners are those of v, kinetic energy is not more [m/s].
  void rigid_velocities(const Points& x, const Points& v, Points& u) const;

  /// Marks all corners of regions that hold a marked one.
  void spread_over_regions(std::vector<std::uint8_t>& is_marked) const;

  double stiffness() const { return stiffness_; }
  const Lines& lines() const { return lines_; }
  const Riders& riders() const { return riders_; }

 private:
  /// What a region is at rest.
  struct Region {
    double mass = 0;            ///< M_r [kg]
    Vec3 centre = Vec3::Zero(); ///< X_r [m]
    double extent = 0;          ///< sum of m_rc |X_c - X_r|^2 [kg m^2]
  };

  void count_shares(const std::vector<Share>& shares);
  void measure_regions();
  /// From 12 or 6 numbers a corner, in corner_field_, to their sums over regions weighted by m_rc, in region_field_.
  void sum_over_regions() const;
  /// From numbers of regions, in region_field_, to their means weighted by m_rc / m_c at corners, in corner_field_.
  void average_over_regions() const;
  /// Fills region_field_ with x_r - R_r X_r and R_r, `centre` taken as origin; returns 2 / k times the energy.
  double match(const Points& x, const Vec3& centre) const;
  /// Of up to eight regions; returns what they add to that.
  double match_block(std::size_t first, std::size_t n) const;
  /// Fills region_field_ with the sums of p, of p p^T (six numbers) and of v, `centre` taken as origin of p.
  void sum_moments(const Points& x, const Points& v, const Vec3& centre) const;
  /// Fills region_field_ with the sums of p x v, and zeros.
  void sum_angular_momentum(const Points& x, const Points& v, const Vec3& centre) const;

  double stiffness_;
  grid::CornerNumbers numbers_;
  Lines lines_;
  Points rest_;              // of the corners, from the body's middle [m]
  std::vector<double> mass_; // of the corners [kg]
  Riders riders_;
  SparseRows<double> of_points_, of_corners_; // s_cn / N_n by point; by corner, over m_c
  std::vector<Region> regions_;
  mutable std::vector<double> corner_field_, region_field_; // scratch
};

} // namespace kerf::lattice
