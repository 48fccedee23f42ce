#pragma once

/// Geometric multigrid on the copies of a cut body, a preconditioner for the equations of implicit steps and of
/// statics:
///
///     A = mass_factor M + stiffness_factor K + loads, among the directions that supports leave free.
///
/// Levels: coarsening.h, elements on them: coarse_elements.h, with the mean rotation of their children; so all levels
/// are the same kernels. M is lumped on every level, restricted with the weights of the transfer. What loads resist at
/// points, as where a skin is held, is restricted exactly, and the corners that it joins are smoothed together
/// (clusters.h); what they resist between two points is lumped. Penalties of near-empty copies (ghost_penalty.h) go
/// along: for motions of the coarse cubes a face's second differences are half those across the coarse face, and vanish
/// within a coarse copy. Ties at fronts (ties.h) are ties of the coarse corners, and vanish where these are one. Coarse
/// levels do not know supports, but springs in their place, of the size of the stiffness that they hold.
///
/// A cycle is deal.II's V (cycle.h), smoothed before and after by the same Chebyshev polynomial of block Jacobi's
/// matrix (Adams, Brezina, Hu and Tuminaro 2003, Parallel multigrid smoothing, J. Comput. Phys. 188), of twice the
/// degree on a coarser level, up to four times (the variable V-cycle of Bramble and Pasciak 1987, New convergence
/// estimates for multigrid algorithms, Math. Comp. 49). So it is symmetric; it is positive as long as the polynomial
/// knows a bound for the largest eigenvalue, which is had element by element (jacobi_bound): elements whose own bound
/// is above that of a full cube count more in the diagonal blocks.
/// The coarsest level is factorised, unless it is large as dust is. All is single precision, but that.
///
/// Departs from Galerkin: a coarse cube turns as a whole, and masses and penalties are lumped; laws other than
/// Hooke's are replaced by his.

#include "base/loan.h"
#include "dynamics/preconditioner.h"
#include "fem/batches.h"
#include "fem/coarsening.h"
#include "fem/cycle.h"
#include "fem/ghost_penalty.h"
#include "fem/incidence.h"
#include "fem/level_elements.h"
#include "fem/ties.h"

#include <memory>

namespace kerf::fem {

/// What multigrid starts from.
struct FinestLevel {
  CellsView cells;
  double h; ///< [m]
  const material::Elastic& material;
  const Element& full;
  std::span<const Kind> kind; ///< of each copy
  std::function<const Element&(std::uint32_t copy)> element;
  std::shared_ptr<const Batching> batching; ///< in an order by the nodes of cells: copies of one coarse cube share one
  BatchedElements<float> elements; ///< partial ones count by their bounds over that of `full`
  std::span<const GhostFace> faces;
  std::span<const Tie> ties;
  const Incidence& incidence;         ///< of the same copies, and the body's corners
  const grid::CornerNumbers& numbers; ///< of these, which the copies have
};

/// What is kept of a hierarchy when a cut makes another one.
struct FormerLevels {
  struct OfLevel {
    Coarsening coarsening; ///< of the level below
    LevelElements elements;
  };
  BatchedElements<float> finest;
  std::vector<Row<float>> diagonal; ///< memory (Multigrid::lend_diagonal)
  std::vector<OfLevel> coarse;
  std::vector<std::uint32_t>
    same_copy; ///< of each finest copy its own number; CellsOfLevel::unused: it has changed since
  std::vector<std::uint32_t> corners; ///< of the finest level, that have other users since
  bool numbers_are_kept = true;       ///< corners have the numbers that they had
};

class Multigrid : public dynamics::Preconditioner {
 public:
  /// Building anew gives the same bits.
  explicit Multigrid(FinestLevel finest, const FormerLevels& former = {});
  ~Multigrid() override;

  /// With one there is nothing coarser, and nothing gained.
  std::size_t n_levels() const;

  /// For one that takes its place; it is of no use any more.
  FormerLevels give_way();

  /// Takes over an equation, with the finest elements' rotations as they are now. Where these have an excess alone in
  /// the diagonal (batches.h), with what they count once: two rows for each that kernels use.
  void prepare(const dynamics::LinearEquation& equation, std::vector<Row<float>> diagonal = {});
  /// Gives the memory of such a diagonal back, for that of the next equation; until it is prepared it is of no use.
  std::vector<Row<float>> lend_diagonal();

  /// Says what of the equation it does not know, after prepare().
  void leave_out(std::unique_ptr<dynamics::StiffPart> part) { left_out_ = std::move(part); }

  void apply(std::span<const double> r, std::span<double> z) override;
  const dynamics::StiffPart* stiff_part() const override { return left_out_.get(); }

 private:
  struct Level;
  struct Coarsest;

  /// Of a coarse level.
  const CellsOfLevel& cells_of(std::size_t coarse) const;
  void make(Level& coarse, const FinestLevel& finest, const FormerLevels& former) const;
  static void put_batches(double h, const material::Elastic& material, const CellsOfLevel& cells, Level& coarse);
  void put_rotations();
  void put_coarse_rotations(std::size_t l);
  Loan<Mat3> sums_of_finest_rotations() const;
  void put_masses(const dynamics::LinearEquation& equation);
  void hold(const dynamics::LinearEquation& equation);

  std::vector<Level> levels_;
  std::unique_ptr<Coarsest> coarsest_;
  std::unique_ptr<Cycle> cycle_;
  std::unique_ptr<dynamics::StiffPart> left_out_; // null: nothing
  double stiffness_factor_ = 1;
};

} // namespace kerf::fem
