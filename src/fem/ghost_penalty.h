#pragma once

/// What holds the corners that hardly any material holds (ghost penalty: Burman 2010; for elasticity Hansbo, Larson and
/// Larsson 2017).
///
/// The problem: a copy with a part f of its cube in it has a stiffness and a mass that vanish with f, and the more so
/// the farther a corner is from the material. Where no other copy knows that corner, nothing holds it: the condition
/// number grows without bound however the equations are scaled, and in large motion the copy turns inside out.
///
/// The method: across a face between two copies that are glued there, of which one is near-empty, the motion shall go
/// on as it is in the other. Trilinear motions are linear along each line of the grid, so their gradients jump by the
/// second differences of the corners a, b, c of the four lines across the face, and the penalty is
///
///     E = sum over faces  k / 2  sum over its four lines  |x_a - 2 x_b + x_c|^2,
///     k = weight mu h need min(1, m / m_ref) / 4,    need = max(0, 1 - f / well_filled),
///
/// f that of the emptier one of the two, m the least mass (below) of the twelve corners: weight mu h times the integral
/// over the face of the squared jump of the normal derivative, with the face's mass matrix lumped. Penalties stand
/// where they are needed: a copy's distance is 0 where it is well-filled, else one face more than that of its nearest
/// glued neighbour; near-empty copies extend their neighbours of less distance, and faces between copies of the same
/// distance have no penalty. (One there would stiffen the bending of a skin along which they lie.) Beyond a distance of
/// 8, in sheets much thinner than a cube, all faces have one.
///
/// The mass that k is measured by, and that explicit integrators take, is the lumped one, extended in the same way:
/// along each of these lines the corner c gets d of the mass of b,
///
///     m_a + d, m_b - 2 d, m_c + d,    d = need / 4  theta max(0, m_b - 4 m_c)  for each face, theta = 1/16,
///
/// and so with a and c exchanged; distance by distance, so that what a corner was given goes on to the next. That keeps
/// the total and the centre of mass, and changes moments of inertia by the order of h^2, as lumping does. Then k falls
/// by a factor for each line between a corner and a well-filled copy, however little material is there, and the largest
/// frequency is that of full cubes.
///
/// What it keeps: E is zero, and exerts no force, for every affine motion, large ones too, so patch tests and rigid
/// motions stay; it is quadratic and convex in x, whatever the deformation and the law; for smooth motions the second
/// differences are of order h^2, so the order of the elements stays. It sees no lambda: near-incompressible bodies do
/// not lock by it.
///
/// Departs from the sources: the weight fades as a copy fills, so that a cut that moves on changes nothing abruptly,
/// and faces between well-filled copies have none; and it is measured by mass, which keeps both spectra flat where
/// several near-empty copies lie in a row (tests/fem/ghost_penalty_test.cc has the figures).

#include "base/loan.h"
#include "base/vec.h"
#include "dynamics/pieces.h"
#include "grid/corner_numbers.h"
#include "grid/solid.h"
#include "material/elastic.h"

#include <Eigen/SparseCore>

#include <functional>
#include <span>
#include <vector>

namespace kerf::fem {

struct GhostPenaltyOptions {
  double weight = 0.03;      ///< [1]; 0: no penalty
  double well_filled = 0.25; ///< part of its cube from which on a copy holds its corners by itself [1]
};

/// A face between two glued copies, one of them near-empty.
struct GhostFace {
  grid::CopyId lower, upper;
  std::uint8_t axis;
  double need;                          ///< in (0, 1] [1]
  std::array<std::uint32_t, 4> a, b, c; ///< corners of the four lines across it: below, in, and above the face
  grid::CopyId well_filled;             ///< of the two copies; invalid: neither
  std::uint8_t distance = 0;            ///< of the farther one of the two copies
  double stiffness = 0;                 ///< k [N/m]
};

class GhostPenalty {
 public:
  GhostPenalty(const GhostPenaltyOptions& options, const material::Elastic& material, double h);

  /// Takes over copies that are new, or whose corners or material have changed. `fill`: the part of its cube that a
  /// copy's material is [1]; `mass`: the lumped one of each corner [kg]. Costs as much as there are changed copies, and
  /// a pass over faces and masses.
  void update(const grid::Solid& solid, std::span<const grid::CopyId> changed,
              const std::function<double(std::size_t copy)>& fill, std::span<const double> mass);

  /// Counts the corners of faces that have a penalty by these numbers, until the next update; masses stay by corner.
  /// Crumbs have no such faces.
  void count_by(const grid::CornerNumbers& numbers);

  /// Those that have a penalty, in the order of their lower copies, axes, and upper copies.
  std::span<const GhostFace> faces() const { return faces_; }
  /// Of each corner, extended to the corners of near-empty copies [kg].
  const std::vector<double>& extended_mass() const { return extended_mass_; }

  double energy(const Points& x) const;
  /// The same, to each piece's what is in it.
  void add_energies(const Points& x, const dynamics::Pieces& pieces, std::span<double> sums) const;
  /// forces -= dE/dx [N].
  void add_force(const Points& x, Points& forces) const;
  /// y += K p [N] for p [m].
  void add_product(std::span<const double> p, std::span<double> y) const;
  /// K is a number times the identity for each pair of corners: the diagonal ones [N/m].
  Loan<double> diagonal(std::size_t n_corners) const;
  void add_entries(std::vector<Eigen::Triplet<double>>& entries) const;

 private:
  /// Nothing for a copy that is well filled but for round-off, as one at an edge in the middle of its cube.
  double need(const double fill) const {
    constexpr double round_off = 1e-9;
    return fill < (1 - round_off) * options_.well_filled ? 1 - fill / options_.well_filled : 0;
  }
  /// Penalties between a copy and those of the cell above it along an axis.
  void add_faces_above(const grid::Solid& solid, grid::CopyId lower, int axis,
                       const std::function<double(std::size_t copy)>& fill, std::vector<GhostFace>& faces) const;

  void choose_faces(std::size_t n_copies);
  void extend_mass();
  void extend_mass_across(std::span<const GhostFace* const> faces, std::vector<double>& shares);
  void weigh_faces();

  GhostPenaltyOptions options_;
  double stiffness_of_cube_, mass_of_cube_; // mu h [N/m], density h^3 [kg]
  std::vector<GhostFace> known_;            // all between a near-empty copy and one that it is glued to
  std::vector<GhostFace> faces_;            // those of them that have a penalty
  std::vector<double> extended_mass_;
};

} // namespace kerf::fem
