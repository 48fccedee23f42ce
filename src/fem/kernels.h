#pragma once

/// The inner loops over elements, on plain pointers, compiled for several instruction sets and chosen at run time.

#include <cstddef>
#include <cstdint>

namespace kerf::fem {

/// A block of elements. Element e has the 8 corner indices at corners + 8 e and the rotation (3 x 3, column by column)
/// at rotations + 9 e. Its stiffness (24 x 24, column by column) is at stiffness + stride element[e], its 8 mean
/// gradients at gradients + stride element[e].
struct ElementBlock {
  std::size_t n;
  const std::uint32_t* corners;
  const std::uint32_t* element;
  const double* stiffness;
  const double* gradients;
  std::size_t stride; ///< in numbers
  const double* rotations;
};

/// out + 24 e = R K R^T p_e, where p_e gathers the 24 values of p at the element's corners.
void apply_stiffness(const ElementBlock& block, const double* p, double* out);

/// out + 24 e += (A : G) b_a for each vertex a, where G = sum p_a b_a^T and A (9 x 9, symmetric) is at tangents + 81 e.
void add_mean_tangent(const ElementBlock& block, const double* tangents, const double* p, double* out);

} // namespace kerf::fem
