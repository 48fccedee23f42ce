#pragma once

/// Hexahedra on the copies of a cut body, for every constitutive law (thesis §2.1.6).
///
/// The energy of a copy is E = V psi(F) + 1/2 u^T K u: the law at the mean deformation gradient F over the copy's
/// material, and Hooke's stiffness K against the rest of its motion (hourglass.h), in the frame u = R^T x - X that
/// turns with F: reduced integration with a physical stabilisation (Puso 2000; Reese and Wriggers 2000). The gradient
/// of an affine motion is its mean, so the patch test holds on every copy. For the corotational law (Mueller and
/// others 2002; Hauth and Strasser 2004) and for small strain, psi is Hooke's too, and both parts are one matrix: the
/// fully integrated element.
///
/// Forces are the exact -dE/dx: they hold the terms of dR/dx, without which an element would exert a torque on itself.
/// The linearisation leaves the derivatives of R out and takes the law's positive tangent, which keeps it positive
/// semi-definite; stiffness_matrix() has the exact second derivative too.
///
/// Copies of crumbs (grid/crumbs.h) have neither mass nor stiffness, and cost nothing in the loops over elements, which
/// go over batches of like ones (batches.h). Their corners cost nothing either where that is asked for: then
/// integrators see those that have a number (numbers()), and all that they give and get is by number. What is asked of
/// one copy or corner is by corner as ever.
///
/// Every copy's element is its own, and sums over copies are taken in an order that the complex alone says: any number
/// of threads, and any way of getting to a complex, gives the same bits. Functions that are const may be called from
/// several threads at once, but for stiffness_diagonal().
///
/// Limits: strain beside the mean one is taken as small, so thin parts one cell across are good for moderate strain.

#include "dynamics/model.h"
#include "dynamics/piece_gains.h"
#include "fem/batches.h"
#include "fem/blocks.h"
#include "fem/consistent_mass.h"
#include "fem/element_table.h"
#include "fem/gathered_mass.h"
#include "fem/ghost_penalty.h"
#include "fem/incidence.h"
#include "fem/known_forces.h"
#include "fem/multigrid.h"
#include "fem/ties.h"
#include "fem/turned.h"
#include "grid/corner_numbers.h"
#include "material/laws.h"

namespace kerf::fem {

/// What integrators get as the mass of a corner.
enum class Inertia {
  lumped,   ///< density times the integral of its shape function
  extended, ///< of that, a part goes to corners that only near-empty copies know (ghost_penalty.h), or only ties hold
            ///< (grid/fronts.h): what explicit integrators need
  gathered  ///< light corners have none (gathered_mass.h): for integrators that take no energy
};

/// The mass matrix that integrators get.
enum class MassMatrix {
  lumped,    ///< diagonal
  consistent ///< that of the shape functions (consistent_mass.h), for implicit integrators
};

struct HexahedraOptions {
  material::Elastic material; ///< and its law
  Boundary boundary = Boundary::octants;
  Strain strain = Strain::trilinear;
  Inertia inertia = Inertia::lumped;
  MassMatrix mass = MassMatrix::lumped;
  GhostPenaltyOptions ghost_penalty = {};
  grid::Counted counted = grid::Counted::all; ///< corners that integrators see
};

class Hexahedra : public dynamics::ElasticModel, public dynamics::StiffnessMatrix, public dynamics::PieceEnergies {
 public:
  Hexahedra(const grid::Solid& solid, const HexahedraOptions& options);

  /// Follows a cut. `changed`: what grid::CutChange::reshaped says. All else stays as it is; the outcome is that of
  /// building anew, bit by bit. The linearisation is lost.
  void update(const grid::Solid& solid, std::span<const grid::CopyId> changed);

  /// Corners as integrators see them.
  const grid::CornerNumbers& numbers() const { return numbers_; }

  std::span<const double> lumped_mass() const override {
    return numbers_.are_all() ? mass_by_corner() : mass_by_number_;
  }
  const dynamics::MassCoupling* mass_coupling() const override { return consistent_mass_.get(); }
  std::span<const dynamics::Follower> followers() const override { return gathered_.followers; }
  double energy(const Points& x) const override;
  double energy_ahead(const Points& x) const override;
  Loan<double> energies(const Points& x, const dynamics::Pieces& pieces) const override;
  void force(const Points& x, Points& forces) const override;
  void linearise(const Points& x) override;
  void apply_stiffness(std::span<const double> p, std::span<double> y) const override;
  /// By one thread at a time: it keeps what multigrid takes of it.
  void stiffness_diagonal(PutBlock put) const override;
  /// Multigrid, where that pays.
  dynamics::Preconditioner* preconditioner(const dynamics::LinearEquation& equation) override;
  Eigen::SparseMatrix<double> stiffness_matrix(const Points& x, dynamics::Tangent kind) const override;

  /// Volume of the material that the elements integrate over [m^3].
  double volume() const;
  double h() const { return h_; } ///< edge of the cubes [m]
  std::size_t n_elements() const { return elements_.n_copies(); }
  /// How many copies have an element of their own.
  std::size_t n_partial() const { return elements_.n_partial(); }

  const material::AnyLaw& law() const { return law_; }
  const material::Elastic& material() const { return material_; }
  const Element& element(const std::size_t copy) const { return elements_[copy]; }
  Frame frame() const { return frame_; }
  const ElementTable& elements() const { return elements_; }
  const Incidence& incidence() const { return incidence_; }
  Inertia inertia() const { return inertia_; }
  /// By corner; soft where inertia is for explicit steps.
  Ties ties(const grid::Solid& solid) const;
  const GhostPenalty& ghost_penalty() const { return ghost_penalty_; }
  /// Mean deformation gradient of a copy [1]; x by corner.
  Mat3 deformation_gradient(std::size_t copy, const Points& x) const;

 private:
  /// What stands in the diagonal of the stiffness stands in multigrid's too.
  bool shares_diagonal() const { return is_hookean() && !leaves_out_dilatation_; }
  bool is_hookean() const { return frame_ == Frame::fixed || std::holds_alternative<material::Corotational>(law_); }
  void follow(const grid::Solid& solid, std::span<const grid::CopyId> changed, std::span<const std::uint32_t> corners);
  void follow_masses_and_penalties(const grid::Solid& solid, std::span<const grid::CopyId> changed,
                                   std::span<const std::uint32_t> corners);
  void sum_mass(std::span<const std::uint32_t> corners);
  void share_mass(const grid::Solid& solid);
  const std::vector<double>& mass_by_corner() const {
    return inertia_ == Inertia::lumped     ? mass_
           : inertia_ == Inertia::gathered ? gathered_.mass
           : tied_mass_.empty()            ? ghost_penalty_.extended_mass()
                                           : tied_mass_;
  }
  /// Takes the corners of all that integrators see by number.
  void count();
  /// Numbers of a copy's corners.
  const std::uint32_t* corner_numbers(const std::size_t copy) const {
    return numbers_.are_all() ? incidence_.corners(copy) : numbers_of_copies_.data() + 8 * copy;
  }
  /// Part of its cube that a copy's material is [1].
  double fill(const std::size_t copy) const { return elements_[copy].volume / (h_ * h_ * h_); }
  ChangeOfBatches batch(const grid::Solid& solid, std::span<const grid::CopyId> changed, CornersOfSame corners);
  PartialElements partial_elements() const;
  /// As the finest level has them.
  PartialElements weighed_partial_elements() const;
  /// Of its elements.
  material::Elastic material_of_multigrid() const;
  void make_multigrid();
  /// Of elements alone, two rows a corner.
  void find_diagonal(Row<double>* blocks) const;
  void keep_diagonal(const Row<double>* blocks) const;
  std::array<Vec3, 8> corners_of(std::size_t copy, const Points& x) const; // x by number
  Turned turned_element(std::size_t copy, const Points& x) const;
  Matrix24 element_matrix(std::size_t copy, const Points& x, dynamics::Tangent kind) const;

  /// F and R of a batch.
  Turns turns(std::size_t batch, const Row<double>* x) const;
  /// Calls f(lane, copy) for each lane of a batch that is used.
  template <class Function>
  void for_each_lane(const std::size_t batch, const Function& f) const {
    const BatchOfCopies& of = batching_->batches()[batch];
    for (std::size_t lane = 0; lane < of.n_used; ++lane)
      f(lane, of.copies[lane]);
  }
  enum class WithEnergy { always, where_cheap };
  /// Whether energies come with forces: laws other than Hooke's take time for them.
  bool gives_energies(const WithEnergy with_energy) const { return with_energy == WithEnergy::always || is_hookean(); }
  /// Of elements alone; `energies` of batches, none where they are not given.
  void find_forces(const Points& x, WithEnergy with_energy, Points& forces, std::vector<double>& energies) const;
  /// The same from what is known since before a cut. False: nothing is.
  bool update_forces(const Points& x, WithEnergy with_energy, Points& forces, std::vector<double>& energies) const;
  void add_forces_between(const Points& x, Points& forces) const; // of copies: penalties and ties
  double energy_of(const Turns& turns, const double* of_lanes, std::size_t lane, std::uint32_t copy) const;
  double energy_of_batch(std::size_t batch, const Turns& turns, const double* of_lanes) const;
  double add_forces(std::size_t batch, WithEnergy with_energy, const Row<double>* x, Row<double>* forces) const;
  double sum_energies(const Points& x, const std::vector<double>& of_batches) const;
  MeanPart mean_part() const { return is_hookean() ? MeanPart::hooke : MeanPart::none; }

  double h_;
  material::AnyLaw law_;
  Frame frame_;
  Inertia inertia_;
  material::Elastic material_;

  ElementTable elements_;
  Incidence incidence_;
  grid::Counted counted_;
  grid::CornerNumbers numbers_;
  std::vector<std::uint32_t> numbers_of_copies_; // 8 a copy; none where all corners have their own
  std::vector<Index3> places_;                   // of the copies' cells
  std::vector<Kind> kinds_;                      // of the copies
  CellsInChunks chunks_;
  std::shared_ptr<Batching> batching_; // null until it is made
  BatchedElements<double> batched_; // rotations and tangents at the linearisation point
  GhostPenalty ghost_penalty_;
  Ties ties_;
  std::vector<double> mass_;                        // by corner
  std::vector<double> mass_by_number_;              // that integrators get; none where all corners have their own
  std::vector<double> tied_mass_;                   // extended, and shared over ties; none where there are none
  GatheredMass gathered_;                           // where it is wanted; followers by number
  std::unique_ptr<ConsistentMass> consistent_mass_; // none where mass is lumped
  std::unique_ptr<Multigrid> multigrid_;            // none until it is asked for
  FormerLevels former_levels_;                      // when it was asked for last, if a cut came since
  bool leaves_out_dilatation_ = false;              // multigrid is made for A of dilatation.h
  /// That multigrid shares with those who ask for stiffness_diagonal() after linearise(), in its memory; of Hooke's
  /// law, which is multigrid's, alone.
  mutable std::vector<Row<float>> diagonal_;
  enum class OfDiagonal { unwanted, wanted, there };
  mutable OfDiagonal of_diagonal_ = OfDiagonal::unwanted;
  mutable KnownForces known_;
};

} // namespace kerf::fem
