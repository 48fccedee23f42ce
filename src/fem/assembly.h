#pragma once

/// Sparse matrices from the matrices of the elements.

#include "fem/hourglass.h"
#include "fem/incidence.h"
#include "grid/corner_numbers.h"

#include <Eigen/SparseCore>

#include <functional>

namespace kerf::fem {

/// Sum of the copies' matrices over 3 n unknowns, both triangles, blocks of 3 x 3 full. `element_matrix(copy)` may be
/// called from several threads; sums are taken in the order of the copies. Corners are counted by `numbers`.
Eigen::SparseMatrix<double> assemble(const Incidence& incidence, const grid::CornerNumbers& numbers,
                                     const std::function<Matrix24(std::size_t copy)>& element_matrix);

} // namespace kerf::fem
