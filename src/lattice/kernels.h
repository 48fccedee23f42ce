#pragma once

/// The inner loops of lattice shape matching, on plain pointers, compiled for several instruction sets and chosen at
/// run time. A field holds `width` numbers an item, one item after the other; the width is 12 (a vector and a matrix)
/// or 6 (two vectors).

#include <array>
#include <cstddef>
#include <cstdint>

namespace kerf::lattice {

/// Lines first .. last - 1: the items of line l are items[start[l]] .. items[start[l + 1] - 1], in their order.
struct LineRange {
  std::size_t first, last;
  const std::uint32_t* start;
  const std::uint32_t* items;
};

/// Replaces each item's numbers by the sum over the items at most `half_width` places away on its line. The cost does
/// not depend on the half width: blocks of 2 w + 1 places, sums from each block's start and to its end, and a window is
/// one end plus one start (van Herk 1992; Gil and Werman 1993, for sums instead of maxima). Nothing is subtracted, so
/// nothing cancels. `scratch` holds 2 width (longest line) numbers.
void sum_windows(const LineRange& lines, std::size_t half_width, std::size_t width, double* field, double* scratch);

/// Rows first .. last - 1 of a sparse matrix: row i has weight[k] at column[k] for k = start[i] .. start[i + 1] - 1.
struct RowRange {
  std::size_t first, last;
  const std::uint32_t* start;
  const std::uint32_t* column;
  const double* weight;
};

/// out_i = sum over k of weight_k in_(column_k), for whole items.
void weighted_sums(const RowRange& rows, std::size_t width, const double* in, double* out);

/// Replaces up to eight matrices (9 numbers, column by column, 12 apart) by the rotations of their polar
/// decompositions: Newton's iteration of Higham (1986), each matrix on its own whatever stands beside it. A matrix that
/// is close to singular, inverted or not finite is left as it is and its bit is set in the result.
unsigned rotate_in_place(std::size_t n, double* matrices);

} // namespace kerf::lattice
