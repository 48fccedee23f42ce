#pragma once

/// Linear equations by a sparse factorisation: L L^T of a positive matrix (CHOLMOD, which deal.II brings), L D L^T of
/// any other symmetric one, L U of the rest (Eigen).

#include "dynamics/constraints.h"

#include <Eigen/SparseCore>

namespace kerf::dynamics {

/// Solves A d = force for d in the directions that are free; d is zero in those that are held. A is 3 n x 3 n [N/m],
/// both triangles. Throws NumericalError when A is singular among the free directions.
void solve_directly(const Eigen::SparseMatrix<double>& A, const Constraints& constraints, const Points& force,
                    Points& d);

} // namespace kerf::dynamics
