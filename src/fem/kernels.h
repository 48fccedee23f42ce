#pragma once

/// The inner loops over elements, on plain pointers, compiled for several instruction sets and chosen at run time.

#include <cstddef>
#include <cstdint>

namespace kerf::fem {

/// A block of elements: for element e, the 8 corner indices at corners + 8 e, the stiffness (24 x 24, column by
/// column) at stiffness[e], the rotation (3 x 3, column by column) at rotations + 9 e.
struct ElementBlock {
  std::size_t n;
  const std::uint32_t* corners;
  const double* const* stiffness;
  const double* rotations;
};

/// out + 24 e = R K R^T p_e, where p_e gathers the 24 values of p at the element's corners.
void apply_stiffness(const ElementBlock& block, const double* p, double* out);

} // namespace kerf::fem
