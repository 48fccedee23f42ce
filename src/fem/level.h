#pragma once

/// One level of multigrid.h: its operator, its smoother, its vectors.

#include "fem/batches.h"
#include "fem/clusters.h"
#include "fem/coarsening.h"
#include "fem/ghost_penalty.h"
#include "fem/ties.h"

#include <functional>
#include <memory>

namespace kerf::fem {

/// k / 2 |x_a - 2 x_b + x_c|^2 across the face between two glued copies.
struct GhostLine {
  std::uint32_t lower, upper; ///< copies
  int axis, vertex;           ///< b is this vertex of the lower copy
  std::uint32_t a, b, c;      ///< corners
  double stiffness;           ///< [N/m]
};
std::vector<GhostLine> lines_of(std::span<const GhostFace> faces);
/// For motions of coarse cubes, lumped to the lines of the coarse faces.
std::vector<GhostLine> coarsened(std::span<const GhostLine> fine, const CellsView& cells, const Coarsening& coarsening);

/// For motions of coarse cubes: sums of squares of mean jumps, at most. None between corners that are one.
std::vector<Tie> coarsened(std::span<const Tie> fine, const Coarsening& coarsening);

/// A symmetric 3 x 3 block at a corner [N/m].
struct Spring {
  std::uint32_t corner;
  Mat3 block;
};

/// d = before d + after D^-1 r.
struct ChebyshevStep {
  float before, after;
};

struct Level {
  std::size_t n_corners = 0;
  std::shared_ptr<const Batching> batching;
  BatchedElements<float> elements;
  double bound = 0; ///< of the eigenvalues of D^-1 A [1]
  static constexpr int fewest_steps = 3, most_steps = 12;
  int n_steps = fewest_steps; ///< of the smoother
  std::vector<GhostLine> lines;
  std::vector<Tie> ties;
  Coarsening to_coarse; ///< of no use on the coarsest

  // The equation, over its stiffness factor.
  std::vector<float> mass;
  std::vector<Spring> springs;
  PointSprings points;
  Clusters clusters;                ///< whose corners have zeros in `inverse`
  std::vector<Row<float>> diagonal; ///< of K and the penalties, two rows a corner (kernels.h), until it is inverted
  std::vector<Row<float>> inverse;  ///< of all blocks among the free directions, likewise; in the memory of `diagonal`
  std::vector<Spring> held;         ///< projectors onto the free directions of corners that are held

  /// Of vectors: a row for each corner, and what batches have for lanes that are not used (kernels.h).
  std::size_t n_rows() const { return batching->n_rows(); }

  /// Calls f(copy) for each, several at a time.
  template <class Function>
  void for_each_copy(const Function& f) const {
    batching->for_each([&](const std::size_t i) { for_each_copy(i, f); });
  }
  /// Calls f(copy) for each; those that share a corner never at once, and in the order of sums.
  template <class Function>
  void for_each_copy_in_order(const Function& f) const {
    batching->for_each_in_order([&](const std::size_t i) { for_each_copy(i, f); });
  }

  /// When cells, batches and lines are there.
  void resize();
  /// From rotations.
  void make_diagonal();
  /// From rotations, where what elements count once in it is known: two rows for each of n_rows().
  void make_diagonal(std::vector<Row<float>> of_elements);
  /// Of all blocks; `inverse_where_held` gives those of corners that are held, among their free directions.
  void invert_diagonal(const std::function<Mat3(std::uint32_t corner, const Mat3& block)>& inverse_where_held);

  // Of b and x, what lies along directions that are held is zero, and stays so.

  /// y = A x.
  void multiply(const Row<float>* x, Row<float>* y);
  /// x near A^-1 b.
  void smooth_from_zero(const Row<float>* b, Row<float>* x);
  /// x nearer to A^-1 b.
  void smooth(const Row<float>* b, Row<float>* x);
  /// Takes out of rows what lies along directions that are held.
  void project(Row<float>* rows) const;

 private:
  template <class Function>
  void for_each_copy(const std::size_t batch, const Function& f) const {
    for (const std::uint32_t copy : batching->batches()[batch].copies)
      if (copy != BatchOfCopies::none)
        f(copy);
  }
  template <class Function>
  void for_each_corner(const Function& f) const;
  void add_penalties_to_diagonal();
  Mat3 inverse_block(std::size_t corner) const;
  void put_inverse_block(std::size_t corner, const Mat3& block);
  void add_of_clusters(float after, Row<float>* x);
  void add_products(const Row<float>* x, Row<float>* y) const;
  template <bool from_zero>
  void take_steps(const Row<float>* b, Row<float>* x);

  struct LineOfProduct {
    std::uint32_t a, b, c;
    float stiffness;
  };
  std::vector<LineOfProduct> lines_of_product_;
  std::vector<Row<float>> r_, d_, t_; // of the smoother: residual, last change of x, and A times that
};

} // namespace kerf::fem
