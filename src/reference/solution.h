#pragma once

/// Displacements in equilibrium, and lowest modes, by deal.II on fitted meshes: the truth that other methods are
/// measured by.
///
/// Elements of FE_Q in a FESystem, degree 1 to 4, curved cells by a mapping of the same degree, hanging nodes and
/// supports in AffineConstraints; sparse direct factorisation (UMFPACK), modes by ARPACK around a shift below all of
/// them.

#include "reference/problem.h"

#include <memory>

namespace kerf::reference {

class Solution {
 public:
  /// [m] at a point of the material, rest configuration; on a crack that of one of its sides. Throws DataError outside.
  virtual Vec3 displacement(const Vec3& X) const = 0;
  /// Elastic energy [J]; of a plane body [J/m].
  virtual double energy() const = 0;
  /// Of a function of place X [m], normal and displacement u [m] over the whole skin, cracks included.
  virtual double over_skin(const std::function<double(const Vec3& X, const Vec3& normal, const Vec3& u)>& f) const = 0;
  /// L2 norm of u - exact [m^(1 + dimension / 2)].
  virtual double distance_to(const Field& exact) const = 0;
  virtual std::size_t n_unknowns() const = 0;
  /// Sum over cells of the estimate, as KellyErrorEstimator gives it [m^(dimension / 2)].
  virtual double estimated_error() const = 0;
  virtual ~Solution() = default;
};

/// Throws ParameterError for a degree or material that cannot be, and where a support or traction meets no face of the
/// skin; NumericalError where the body is free to move.
std::unique_ptr<Solution> solve(const Problem& problem, const Discretisation& discretisation);

/// The n lowest natural frequencies [1/s], ascending; those of a free body begin with zeros. Displacements and
/// tractions that are not zero count for nothing. Throws as solve(), and NumericalError where the iteration does not
/// end.
std::vector<double> lowest_frequencies(const Problem& problem, const Discretisation& discretisation, int n);

} // namespace kerf::reference
