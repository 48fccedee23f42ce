#pragma once

#include "grid/complex.h"

#include <algorithm>

namespace kerf::grid {

/// Copies but those that have lapsed.
inline std::size_t n_copies_in_use(const CellComplex& complex) {
  return std::ranges::count_if(complex.copies, [](const Copy& copy) { return !copy.is_lapsed(); });
}

} // namespace kerf::grid
