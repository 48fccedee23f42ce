#pragma once

/// Masses and springs on the corners of a cut body, the cheap baseline (thesis §2.1.5).
///
/// Springs join the corners of a copy along the cube's 12 edges and 12 face diagonals; copies that share two corners
/// share the spring, and where a cut ends between copies springs of no length tie them (grid/fronts.h). A spring of
/// rest length L and stiffness K has the energy K/2 (l - L)^2 at length l, which is the force of (2.21). Damping (2.22)
/// is the load's beta: a force -beta K v along each spring, K_d = beta K.
///
/// A full cube of edge h gets K = E h / 10 along edges and E h / 5 along face diagonals: then uniform strain has the
/// energy of Hooke's law with Young's modulus E and nu = 1/4 (what central forces between like neighbours can do:
/// lambda = mu), in every direction, and full cubes pass the patch test with free surfaces too. Springs along the
/// body's diagonals could take a part of it, but spoil that: they answer shear in one plane with forces across it.
///
/// A copy counts with its material's part of the cube, springs and mass alike: a cut does not double either. Its mass
/// is spread evenly over its corners: then no sliver has a frequency above a full cube's, and the stable step of
/// explicit integrators does not depend on the cuts.
///
/// Springs know no inside out: what has lost half its volume resists besides (inversion.h).
///
/// Limits: nu is 1/4 whatever the material; the mass of a partial copy is exact, its centre is the cube's; small strain
/// only follows Hooke's law.

#include "dynamics/model.h"
#include "dynamics/piece_gains.h"
#include "grid/corner_numbers.h"
#include "grid/fronts.h"
#include "spring/inversion.h"

#include <optional>

namespace kerf::spring {

struct MassSpringOptions {
  double density = 1000;                      ///< [kg/m^3]
  double youngs_modulus = 1e4;                ///< E [Pa]
  grid::Counted counted = grid::Counted::all; ///< corners that integrators see
  grid::TieStiffness ties = grid::TieStiffness::of_fronts;
};

/// The only value that these springs can have [1].
constexpr double poissons_ratio = 0.25;

class MassSpring : public dynamics::ElasticModel,
                   public dynamics::StiffnessMatrix,
                   public dynamics::PieceEnergies {
 public:
  /// Throws ParameterError for an option that makes no sense.
  MassSpring(const grid::Solid& solid, const MassSpringOptions& options);

  /// Corners as integrators see them: all that they give and get is by number.
  const grid::CornerNumbers& numbers() const { return numbers_; }

  std::span<const double> lumped_mass() const override { return mass_; }
  double energy(const Points& x) const override;
  Loan<double> energies(const Points& x, const dynamics::Pieces& pieces) const override;
  void force(const Points& x, Points& forces) const override;
  /// K leaves out what a compressed spring loses across itself, which keeps it positive semi-definite (Choi and Ko
  /// 2002).
  void linearise(const Points& x) override;
  void apply_stiffness(std::span<const double> p, std::span<double> y) const override;
  void stiffness_diagonal(PutBlock put) const override;
  Eigen::SparseMatrix<double> stiffness_matrix(const Points& x, dynamics::Tangent kind) const override;

  std::size_t n_springs() const { return springs_.size(); }

 private:
  struct Spring {
    std::uint32_t a, b; ///< numbers of corners, a < b
    double stiffness;   ///< K [N/m]
    double length;      ///< at rest [m]
  };
  /// A spring's stiffness at the linearisation point: along n, and across it [N/m].
  struct Direction {
    Vec3 n = Vec3::Zero();
    double along = 0, across = 0;

    Vec3 times(const Vec3& d) const { return across * d + (along - across) * n.dot(d) * n; }
    Mat3 matrix() const { return across * Mat3::Identity() + (along - across) * n * n.transpose(); }
  };
  static double energy_of(const Spring& spring, const Points& x);
  static Direction direction(const Spring& spring, const Points& x, dynamics::Tangent kind);

  void add_springs(const grid::Solid& solid, const std::vector<double>& fill, const MassSpringOptions& options);
  void find_users();
  /// y_c = sum of what springs do to corner c: plus at a, minus at b.
  void gather(const Points& of_springs, double* y) const;

  grid::CornerNumbers numbers_;
  std::vector<Spring> springs_;                   // sorted by corners
  std::vector<std::uint32_t> user_start_, users_; // by corner: 2 spring + end
  std::vector<double> mass_;
  std::optional<Inversion> inversion_;
  std::vector<Direction> directions_;
  mutable Points of_springs_; // scratch
};

} // namespace kerf::spring
