#pragma once

/// Point-based animation (thesis §2.1.7; Mueller, Keiser, Nealen, Pauly, Gross and Alexa 2004, Symposium on Computer
/// Animation, 141-151) as a model. Unknowns are the positions of the phyxels,
///
///     energy(x) = sum_i V_i Psi(B_i M_i) + 1/2 sum_i kappa_i sum_j w_ij |x_j - x_i - B_i X_ij|^2
///
/// with B_i the gradient by moving least squares, M_i what is known of it (fit.h) and Psi the law (law.h). Forces are
/// the exact -dE/dx. Written pair by pair they are
///
///     f_i += (T_i + T_j) w_ij X_ij + (kappa_i + kappa_j) w_ij (x_j - x_i),   T_i = V_i (P_i M_i) A_i^+ - kappa_i B_i
///
/// and f_j the opposite, bit by bit: momentum is kept. E does not see rotations, so angular momentum is kept too.
///
/// The second sum controls the zero-energy modes: gradients do not see a phyxel that moves against all its neighbours.
/// It punishes what an affine motion of the neighbourhood leaves over, as Ganzenmueller 2015 does (Computer Methods in
/// Applied Mechanics and Engineering 286, 87-106); departs from it in that the whole residual counts, not only its
/// part along the pair, and that the weights are those of the fit: the energy is then a quadratic form, derivatives of
/// B drop out, no state is unstable, and it fades with the sights. kappa_i = c E V_i / (tr(A_i) / 3 with nothing in
/// sight), c the option.
///
/// The law of material::Elastic is not asked for: it is Green's strain with Hooke's law whatever its name.
///
/// Links (links.h) are bonds beside those of neighbours, for parts of a piece that no neighbours join. With w_ij (V_i /
/// m_i + V_j / m_j) = area / length, m_i = tr(A_i) / 3 with nothing in sight, the second sum makes them as stiff as the
/// material along their way, c E area / length; no link weighs more than 1. A link is unstrained as it finds its
/// phyxels: with offset X = (F_i^-1 + F_j^-1) (x_j - x_i) / 2 for X_ij it brings hardly any energy.
///
/// Limits: nodal integration passes the patch test of equilibrium only where the phyxels lie on a lattice; Green's
/// strain with Hooke's law softens in strong compression.

#include "base/archive.h"
#include "dynamics/model.h"
#include "material/elastic.h"
#include "pba/fit.h"
#include "pba/law.h"
#include "pba/links.h"
#include "pba/neighbours.h"

namespace kerf::pba {

struct ModelOptions {
  double stabilisation = 1; ///< c [1]
  double volume_share = 1;  ///< of lambda, where positive: acts on the volume [1]
  /// Where the extent of a neighbourhood across some direction, squared, falls below this part of an uncut one's, the
  /// direction is let go. A quarter of a neighbourhood keeps about 0.1, an eighth 0.05.
  double rank_threshold = 0.1;
  dynamics::Tangent tangent = dynamics::Tangent::positive; ///< of linearise()

  void describe(Parameters& p) {
    p.number("Stabilisation [1]", stabilisation, non_negative,
             "Penalty on motion that gradients do not see, over Young's modulus.");
    p.number("Volume share [1]", volume_share, {.min = 0, .max = 1},
             "Part of Lame's lambda that acts on the volume; the rest acts on the trace of Green's strain.");
    p.number("Rank threshold [1]", rank_threshold, {.min = 0, .max = 0.1, .min_excluded = true},
             "Extent of a neighbourhood, squared, over that of an uncut one, below which a direction is let go.");
  }
};

/// Deformation gradients, and how much of each is known (Fit::determinant).
struct Deformed {
  std::vector<Mat3> F;
  std::vector<double> known;
};

class PhyxelModel : public dynamics::ElasticModel {
 public:
  /// Nothing is in sight but neighbours. Throws ParameterError for an option out of its range.
  PhyxelModel(Phyxels phyxels, Neighbours neighbours, const material::Elastic& material, const ModelOptions& options);
  /// Of a cloud without a body: all that are near are neighbours.
  PhyxelModel(Phyxels phyxels, const material::Elastic& material, const ModelOptions& options);

  /// What stands between the phyxels now: one sight for each of neighbours().pairs. Only what changed is made anew.
  void update(std::span<const Sight> sights);
  Deformed deformed(const Points& x) const;
  /// These links and no others count as bonds now, new ones unstrained at x: of their ends the one that knows more of its
  /// gradient counts more. `before`: of x, as all was in sight before what makes links necessary; a phyxel that has just
  /// lost its last bond knows no more how it is turned. Links that did before keep their offsets, and their weights
  /// where these would grow.
  void link(std::span<const Link> links, const Points& x, const Deformed& before);
  /// Leaves the mass of these (1) to whoever carries them; their sights must be none.
  void carry(std::span<const std::uint8_t> carried);

  /// Its sights, its links and who is carried; into a model of the same phyxels and options. The linearisation is lost.
  void archive(Archive& a);

  const Phyxels& phyxels() const { return phyxels_; }
  const Neighbours& neighbours() const { return neighbours_; }
  /// What is known of the gradient at each phyxel.
  const std::vector<Fit>& fits() const { return fits_; }
  /// Weight of each pair [1].
  std::span<const double> weights() const { return weights_; }
  /// The links that count, without supports, and the weight of each [1].
  const Neighbours& links() const { return links_; }
  std::span<const double> link_weights() const { return link_weights_; }

  std::span<const double> lumped_mass() const override { return mass_; }
  double energy(const Points& x) const override;
  void force(const Points& x, Points& forces) const override;
  void linearise(const Points& x) override;
  void apply_stiffness(std::span<const double> p, std::span<double> y) const override;
  void stiffness_diagonal(PutBlock put) const override;

  /// Deformation gradient at each phyxel [1], completed where it is not known.
  void deformation(const Points& x, std::vector<Mat3>& F) const;

 private:
  /// What phyxel i sees of phyxel j.
  struct Bond {
    Vec3 moment; ///< w_ij X_ij [m]
    double weight;
    Vec3 offset; ///< X_ij [m]
    std::uint32_t other;
  };

  void make(std::size_t i);
  void make_all();
  std::span<const Bond> bonds(std::size_t i) const;
  /// B_i for any field of points, positions or changes of them.
  template <class At>
  Mat3 gradient(std::size_t i, const At& at) const;
  /// T for each phyxel, then the sum over pairs: f_i += (T_i + T_j) w_ij X_ij + (kappa_i + kappa_j) w_ij (x_j - x_i).
  template <class At, class Stress>
  void pair_forces(const At& at, const Stress& stress, double* forces) const;

  Phyxels phyxels_;
  Neighbours neighbours_;
  ModelOptions options_;
  double density_, youngs_modulus_;
  Law law_;
  std::vector<double> mass_, weights_;
  std::vector<double> reference_, kappa_; // by phyxel: tr(A) / 3 with nothing in sight; [N/m]
  Neighbours links_;                      // by their pairs
  std::vector<double> link_weights_;
  Points link_offsets_;     // from the first to the second phyxel [m]
  std::vector<Bond> bonds_; // of each phyxel: to neighbours, then links
  std::vector<Fit> fits_;
  std::vector<Linearised> linearised_;
};

} // namespace kerf::pba
