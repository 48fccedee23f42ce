#pragma once

/// The springs that hold copies together where a cut ends between them (grid/fronts.h): E = sum of k/2 |x_a - x_b|^2.

#include "dynamics/pieces.h"
#include "grid/corner_numbers.h"
#include "grid/fronts.h"
#include "material/elastic.h"

#include <Eigen/SparseCore>

#include <span>

namespace kerf::fem {

struct Tie {
  std::uint32_t a, b; ///< corners
  double stiffness;   ///< [N/m]
};

class Ties {
 public:
  /// Takes over all of them. Soft ones, as explicit steps need, where masses of corners are given [kg].
  void update(const grid::Solid& solid, const material::Elastic& material, std::span<const double> mass = {});
  /// Counts corners by these numbers from now on. No tie is at a corner that has none: crumbs have no ties.
  void count_by(const grid::CornerNumbers& numbers);

  std::span<const Tie> all() const { return ties_; }
  double energy(const Points& x) const;
  /// The same, to each piece's what is in it.
  void add_energies(const Points& x, const dynamics::Pieces& pieces, std::span<double> sums) const;
  /// forces -= dE/dx [N].
  void add_force(const Points& x, Points& forces) const;
  /// y += K p [N] for p [m].
  void add_product(std::span<const double> p, std::span<double> y) const;
  /// K is a number times the identity for each pair of corners: adds the diagonal ones [N/m].
  void add_diagonal(std::span<double> diagonal) const;
  void add_entries(std::vector<Eigen::Triplet<double>>& entries) const;

 private:
  std::vector<Tie> ties_;
};

} // namespace kerf::fem
