#include "lattice/kernels.h"

#include <algorithm>
#include <cmath>

namespace kerf::lattice {

namespace {

/// Inlined into each clone, so that it is compiled for that instruction set.
template <std::size_t N>
[[gnu::always_inline]] inline void add(const double* const a, const double* const b, double* const sum) {
  for (std::size_t k = 0; k < N; ++k)
    sum[k] = a[k] + b[k];
}

template <std::size_t N>
[[gnu::always_inline]] inline void copy(const double* const from, double* const to) {
  for (std::size_t k = 0; k < N; ++k)
    to[k] = from[k];
}

/// A line of no more than w + 1 items: every window is all of it.
template <std::size_t N>
[[gnu::always_inline]] inline void sum_short_line(const std::uint32_t* const items, const std::size_t n,
                                                  double* const field) {
  double total[N];
  copy<N>(field + N * items[0], total);
  for (std::size_t i = 1; i < n; ++i)
    add<N>(total, field + N * items[i], total);
  for (std::size_t i = 0; i < n; ++i)
    copy<N>(total, field + N * items[i]);
}

template <std::size_t N>
[[gnu::always_inline]] inline void sum_long_line(const std::uint32_t* const items, const std::size_t n,
                                                 const std::size_t w, double* const field, double* const scratch) {
  const std::size_t block = 2 * w + 1;
  double *const from_start = scratch, *const to_end = scratch + N * n;
  for (std::size_t b = 0; b < n; b += block) {
    const std::size_t end = std::min(n, b + block);
    copy<N>(field + N * items[b], from_start + N * b);
    for (std::size_t i = b + 1; i < end; ++i)
      add<N>(from_start + N * (i - 1), field + N * items[i], from_start + N * i);
    copy<N>(field + N * items[end - 1], to_end + N * (end - 1));
    for (std::size_t i = end - 1; i-- > b;)
      add<N>(to_end + N * (i + 1), field + N * items[i], to_end + N * i);
  }
  for (std::size_t i = 0; i <= w; ++i)
    copy<N>(from_start + N * std::min(i + w, n - 1), field + N * items[i]);
  // From here on the window starts at a = i - w > 0, `phase` places after the start of a block.
  std::size_t a = 1, phase = 1;
  for (; a + 2 * w < n; ++a, phase = phase + 1 == block ? 0 : phase + 1) {
    if (phase == 0)
      copy<N>(from_start + N * (a + 2 * w), field + N * items[a + w]);
    else
      add<N>(to_end + N * a, from_start + N * (a + 2 * w), field + N * items[a + w]);
  }
  for (; a + w < n; ++a, phase = phase + 1 == block ? 0 : phase + 1) { // the line ends inside the window
    if (phase == 0 || a - phase + block >= n)
      copy<N>(to_end + N * a, field + N * items[a + w]);
    else
      add<N>(to_end + N * a, from_start + N * (n - 1), field + N * items[a + w]);
  }
}

template <std::size_t N>
[[gnu::always_inline]] inline void sum_windows_of(const LineRange& lines, const std::size_t w, double* const field,
                                                  double* const scratch) {
  for (std::size_t l = lines.first; l < lines.last; ++l) {
    const std::uint32_t* const items = lines.items + lines.start[l];
    const std::size_t n = lines.start[l + 1] - lines.start[l];
    if (n <= w + 1)
      sum_short_line<N>(items, n, field);
    else
      sum_long_line<N>(items, n, w, field, scratch);
  }
}

template <std::size_t N>
[[gnu::always_inline]] inline void weighted_sums_of(const RowRange& rows, const double* const in, double* const out) {
  for (std::size_t i = rows.first; i < rows.last; ++i) {
    double sum[N] = {};
    for (auto k = rows.start[i]; k < rows.start[i + 1]; ++k) {
      const double weight = rows.weight[k];
      const double* const item = in + N * rows.column[k];
      for (std::size_t j = 0; j < N; ++j)
        sum[j] += weight * item[j];
    }
    copy<N>(sum, out + N * i);
  }
}

} // namespace

__attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default"))) void sum_windows(
  const LineRange& lines, const std::size_t half_width, const std::size_t width, double* const field,
  double* const scratch) {
  if (width == 12)
    sum_windows_of<12>(lines, half_width, field, scratch);
  else
    sum_windows_of<6>(lines, half_width, field, scratch);
}

__attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default"))) void weighted_sums(
  const RowRange& rows, const std::size_t width, const double* const in, double* const out) {
  if (width == 12)
    weighted_sums_of<12>(rows, in, out);
  else
    weighted_sums_of<6>(rows, in, out);
}

__attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default"))) unsigned rotate_in_place(
  const std::size_t n, double* const matrices) {
  constexpr int lanes = 8, max_iterations = 24;
  constexpr double well_conditioned = 1e-5, converged = 1e-16; // one more iteration would square that
  alignas(64) double X[9][lanes], change[lanes], det[lanes];
  for (int l = 0; l < lanes; ++l) {
    const double* const A = matrices + 12 * std::min<std::size_t>(l, n - 1);
    double square = 0;
    for (int i = 0; i < 9; ++i)
      square += A[i] * A[i];
    const double scale = std::sqrt(3 / square);
    for (int i = 0; i < 9; ++i)
      X[i][l] = scale * A[i];
    change[l] = 1;
  }
  unsigned failed = 0;
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    double largest_change = 0;
    for (int l = 0; l < lanes; ++l) {
      const double a = X[0][l], b = X[1][l], c = X[2][l], d = X[3][l], e = X[4][l], f = X[5][l], g = X[6][l],
                   h = X[7][l], k = X[8][l];
      const double cofactors[9] = {e * k - f * h, f * g - d * k, d * h - e * g, c * h - b * k, a * k - c * g,
                                   b * g - a * h, b * f - c * e, c * d - a * f, a * e - b * d};
      const double determinant = a * cofactors[0] + b * cofactors[1] + c * cofactors[2];
      const double half_inverse = 0.5 / determinant;
      const double keep = change[l] < converged ? 1 : 0;
      double square = 0;
      for (int i = 0; i < 9; ++i) {
        const double next = keep != 0 ? X[i][l] : 0.5 * X[i][l] + half_inverse * cofactors[i];
        square += (next - X[i][l]) * (next - X[i][l]);
        X[i][l] = next;
      }
      det[l] = determinant;
      change[l] = square;
    }
    if (iteration == 0)
      for (int l = 0; l < lanes; ++l)
        failed |= unsigned(!(det[l] > well_conditioned)) << l;
    for (int l = 0; l < lanes; ++l)
      largest_change = std::max(largest_change, failed >> l & 1 ? 0 : change[l]);
    if (largest_change < converged)
      break;
  }
  for (int l = 0; l < lanes; ++l)
    failed |= unsigned(!(change[l] < converged)) << l;
  for (std::size_t l = 0; l < n; ++l)
    if (!(failed >> l & 1))
      for (int i = 0; i < 9; ++i)
        matrices[12 * l + i] = X[i][l];
  return failed & ((1u << n) - 1);
}

} // namespace kerf::lattice
