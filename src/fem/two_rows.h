#pragma once

/// Rows of corners that kernels read and write, for one call.

#include "base/loan.h"
#include "base/parallel.h"
#include "fem/kernels.h"

#include <span>

namespace kerf::fem {

constexpr std::size_t many_corners_of_copies = 4096; // corners from which on a second thread pays

/// Room for two rows a corner, one vector after the other, of any values.
struct TwoRows {
  explicit TwoRows(const std::size_t n) : lent(2 * n, AnyValues()), first(lent.data()), second(first + n) {}

  Loan<Row<double>> lent;
  Row<double>*first, *second;
};

/// A row for each corner, and zeros after them; clears as many `sums` on the way, where there are some.
inline void put_rows(const std::span<const double> values, const std::size_t n_rows, Row<double>* const rows,
                     Row<double>* const sums = nullptr) {
  const std::size_t n = values.size() / 3;
  parallel_for(
    n_rows,
    [&](const std::size_t i) {
      rows[i] = i < n ? Row<double>{values[3 * i], values[3 * i + 1], values[3 * i + 2]} : Row<double>{};
      if (sums)
        sums[i] = {};
    },
    many_corners_of_copies);
}

/// Three numbers of each row.
inline void write(const Row<double>* const rows, const std::span<double> y) {
  parallel_for(
    y.size() / 3,
    [&](const std::size_t i) {
      y[3 * i] = rows[i].x;
      y[3 * i + 1] = rows[i].y;
      y[3 * i + 2] = rows[i].z;
    },
    many_corners_of_copies);
}

} // namespace kerf::fem
