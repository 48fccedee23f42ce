#pragma once

/// Entries of sparse matrices from the matrices of the elements.

#include "fem/hourglass.h"
#include "fem/incidence.h"
#include "grid/corner_numbers.h"

#include <Eigen/SparseCore>

#include <functional>
#include <vector>

namespace kerf::fem {

/// Adds those of the copies' matrices over 3 n unknowns, in the order of the copies. `element_matrix(copy)` may be
/// called from several threads. Corners are counted by `numbers`.
void add_entries(const Incidence& incidence, const grid::CornerNumbers& numbers,
                 const std::function<Matrix24(std::size_t copy)>& element_matrix,
                 std::vector<Eigen::Triplet<double>>& entries);

} // namespace kerf::fem
