#pragma once

/// The consistent mass matrix of the elements, beside the lumped one that it is added to: M_ab = density times the
/// integral of N_a N_b over the material, for each copy. Its rows sum to the lumped masses, so M - diag(m) is minus a
/// graph Laplacian, with weights M_ab: it moves no momentum.
///
/// Where mass is extended to corners that only near-empty copies know (ghost_penalty.h), a corner keeps the part r_a <=
/// 1 of its mass, and weights become M_ab min(r_a, r_b). What results stays positive: min(r_a, r_b) is the integral
/// over s in (0, 1) of whether both r_a and r_b exceed s, and for each s the sum is M between the corners that do, and
/// a diagonal that is not negative.

#include "dynamics/model.h"
#include "fem/element_table.h"
#include "fem/incidence.h"
#include "grid/corner_numbers.h"

namespace kerf::fem {

class ConsistentMass : public dynamics::MassCoupling {
 public:
  /// All must outlive it. `density` [kg/m^3], `h` [m]. Products and entries are by `numbers`.
  ConsistentMass(const ElementTable& elements, const Incidence& incidence, const grid::CornerNumbers& numbers,
                 double density, double h);

  /// Follows a cut, as the two have. Masses by corner [kg].
  void update(const grid::Solid& solid, std::span<const grid::CopyId> changed, std::span<const double> lumped,
              std::span<const double> extended);

  void add_product(std::span<const double> p, std::span<double> y) const override;
  void add_entries(double factor, std::vector<Eigen::Triplet<double>>& entries) const override;

 private:
  static constexpr std::size_t n_pairs = 36;
  using Pairs = std::array<double, n_pairs>; // M_ab at pair_index(a, b) [kg]

  Pairs pairs_of(const Moments& moments) const;
  /// Calls f(corner, weight) for each corner beside `corner`, in each copy that knows both.
  template <class Function>
  void for_each_neighbour(std::size_t corner, const Function& f) const;

  const ElementTable& elements_;
  const Incidence& incidence_;
  const grid::CornerNumbers& numbers_;
  double mass_of_cube_;
  std::vector<Pairs> pairs_;            // [0] is the full cube's
  std::vector<std::uint32_t> pairs_of_; // by copy
  std::vector<double> kept_;            // r, by corner [1]
};

} // namespace kerf::fem
