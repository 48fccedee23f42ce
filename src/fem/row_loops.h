#pragma once

/// How kernels read and write the rows of corners, for numbers T and vectors of W of them. All is inlined into
/// functions of one instruction set each, so this file is for kernels.cc alone.

#include "fem/kernels.h"

#include <utility>

namespace kerf::fem {

template <class T, int W>
struct RowLoops {
  typedef T V __attribute__((vector_size(sizeof(T) * W)));
  typedef T Four __attribute__((vector_size(sizeof(T) * 4)));

  [[gnu::always_inline]] static V load(const T* const p) { return *reinterpret_cast<const V*>(p); }
  [[gnu::always_inline]] static void store(T* const p, const V& v) { *reinterpret_cast<V*>(p) = v; }

  [[gnu::always_inline]] static Four row(const Row<T>* const p, const std::uint32_t i) {
    return *reinterpret_cast<const Four*>(p + i);
  }
  /// Rows of W / 4 corners beside each other, of each fourth one.
  [[gnu::always_inline]] static V rows(const Row<T>* const p, const std::uint32_t* const corners) {
    if constexpr (W == 4) {
      return row(p, corners[0]);
    } else {
      const auto low = __builtin_shufflevector(row(p, corners[0]), row(p, corners[4]), 0, 1, 2, 3, 4, 5, 6, 7);
      if constexpr (W == 8) {
        return low;
      } else {
        const auto high = __builtin_shufflevector(row(p, corners[8]), row(p, corners[12]), 0, 1, 2, 3, 4, 5, 6, 7);
        return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
      }
    }
  }
  /// In each four numbers those named of a's (0 to 3) and of b's (4 to 7).
  template <int i, int j, int k, int l>
  [[gnu::always_inline]] static V in_fours(const V& a, const V& b) {
    return in_fours<i, j, k, l>(a, b, std::make_integer_sequence<int, W>());
  }
  template <int i, int j, int k, int l, int... lanes>
  [[gnu::always_inline]] static V in_fours(const V& a, const V& b, std::integer_sequence<int, lanes...>) {
    constexpr int which[4] = {i, j, k, l};
    return __builtin_shufflevector(a, b, (lanes / 4 * 4 + which[lanes % 4] % 4 + (which[lanes % 4] < 4 ? 0 : W))...);
  }
  /// A row of doubles is as long as two of the 128 bits within which instructions shuffle cheaply: so rows are taken
  /// apart within these first, and then by whole ones. (Twice as many instructions otherwise, with AVX2.)
  static constexpr bool crosses_lanes = sizeof(T) == 8;

  /// Reads the rows of W corners.
  [[gnu::always_inline]] static void read(const std::uint32_t* const corners, const Row<T>* const p, V (&v)[3]) {
    const V r0 = rows(p, corners), r1 = rows(p, corners + 1), r2 = rows(p, corners + 2), r3 = rows(p, corners + 3);
    if constexpr (crosses_lanes) {
      const V xz01 = in_fours<0, 4, 2, 6>(r0, r1), xz23 = in_fours<0, 4, 2, 6>(r2, r3);
      const V y01 = in_fours<1, 5, 3, 7>(r0, r1), y23 = in_fours<1, 5, 3, 7>(r2, r3);
      v[0] = in_fours<0, 1, 4, 5>(xz01, xz23);
      v[1] = in_fours<0, 1, 4, 5>(y01, y23);
      v[2] = in_fours<2, 3, 6, 7>(xz01, xz23);
    } else {
      const V xy01 = in_fours<0, 4, 1, 5>(r0, r1), xy23 = in_fours<0, 4, 1, 5>(r2, r3);
      const V z01 = in_fours<2, 6, 3, 7>(r0, r1), z23 = in_fours<2, 6, 3, 7>(r2, r3);
      v[0] = in_fours<0, 1, 4, 5>(xy01, xy23);
      v[1] = in_fours<2, 3, 6, 7>(xy01, xy23);
      v[2] = in_fours<0, 1, 4, 5>(z01, z23);
    }
  }
  /// Adds to the rows of W corners, one after the other.
  [[gnu::always_inline]] static void add(const V& x, const V& y, const V& z, const std::uint32_t* const corners,
                                         Row<T>* const p, const int stride = 1) {
    const V none = {};
    V of_rows[4];
    if constexpr (crosses_lanes) {
      const V xy02 = in_fours<0, 4, 2, 6>(x, y), xy13 = in_fours<1, 5, 3, 7>(x, y);
      const V z02 = in_fours<0, 4, 2, 6>(z, none), z13 = in_fours<1, 5, 3, 7>(z, none);
      of_rows[0] = in_fours<0, 1, 4, 5>(xy02, z02);
      of_rows[1] = in_fours<0, 1, 4, 5>(xy13, z13);
      of_rows[2] = in_fours<2, 3, 6, 7>(xy02, z02);
      of_rows[3] = in_fours<2, 3, 6, 7>(xy13, z13);
    } else {
      const V xy01 = in_fours<0, 4, 1, 5>(x, y), xy23 = in_fours<2, 6, 3, 7>(x, y);
      const V z01 = in_fours<0, 4, 1, 5>(z, none), z23 = in_fours<2, 6, 3, 7>(z, none);
      of_rows[0] = in_fours<0, 1, 4, 5>(xy01, z01);
      of_rows[1] = in_fours<2, 3, 6, 7>(xy01, z01);
      of_rows[2] = in_fours<0, 1, 4, 5>(xy23, z23);
      of_rows[3] = in_fours<2, 3, 6, 7>(xy23, z23);
    }
#pragma GCC unroll 4
    for (int g = 0; g < W / 4; ++g)
#pragma GCC unroll 4
      for (int k = 0; k < 4; ++k)
        *reinterpret_cast<Four*>(p + stride * corners[4 * g + k]) += four_of(of_rows[k], g);
  }
  [[gnu::always_inline]] static Four four_of(const V& v, const int g) {
    if constexpr (W == 4)
      return v;
    else if constexpr (W == 8)
      return g == 0 ? __builtin_shufflevector(v, v, 0, 1, 2, 3) : __builtin_shufflevector(v, v, 4, 5, 6, 7);
    else
      return g == 0   ? __builtin_shufflevector(v, v, 0, 1, 2, 3)
             : g == 1 ? __builtin_shufflevector(v, v, 4, 5, 6, 7)
             : g == 2 ? __builtin_shufflevector(v, v, 8, 9, 10, 11)
                      : __builtin_shufflevector(v, v, 12, 13, 14, 15);
  }

  // Of cubes in a row along x: one has the nodes 1, 3, 5, 7 that the next one has as 0, 2, 4, 6.

  /// Lanes 1, 2, ... of v, and then `last`.
  [[gnu::always_inline]] static V moved_down(const V& v, const T last) {
    return moved_down(v, last - V{}, std::make_integer_sequence<int, W>());
  }
  template <int... lanes>
  [[gnu::always_inline]] static V moved_down(const V& v, const V& last, std::integer_sequence<int, lanes...>) {
    return __builtin_shufflevector(v, last, (lanes + 1)...);
  }
  /// 0, and then lanes 0, 1, ... of v but the last.
  [[gnu::always_inline]] static V moved_up(const V& v) {
    return moved_up(v, V{}, std::make_integer_sequence<int, W>());
  }
  template <int... lanes>
  [[gnu::always_inline]] static V moved_up(const V& v, const V& none, std::integer_sequence<int, lanes...>) {
    return __builtin_shufflevector(none, v, (lanes == 0 ? 0 : W + lanes - 1)...);
  }
  /// Reads the rows of all nodes.
  [[gnu::always_inline]] static void read_nodes(const Batch<T>& batch, const int lane, const Row<T>* const p,
                                                V (&c)[8][3]) {
    if (!batch.is_row) {
#pragma GCC unroll 8
      for (int a = 0; a < 8; ++a)
        read(batch.corners[a] + lane, p, c[a]);
      return;
    }
#pragma GCC unroll 4
    for (int a = 0; a < 8; a += 2) {
      read(batch.corners[a] + lane, p, c[a]);
      const Row<T>& last = p[batch.corners[a + 1][lane + W - 1]];
      c[a + 1][0] = moved_down(c[a][0], last.x);
      c[a + 1][1] = moved_down(c[a][1], last.y);
      c[a + 1][2] = moved_down(c[a][2], last.z);
    }
  }
  /// Adds to the rows of all nodes.
  [[gnu::always_inline]] static void add_nodes(const Batch<T>& batch, const int lane, const V (&f)[8][3],
                                               Row<T>* const y) {
    if (!batch.is_row) {
#pragma GCC unroll 8
      for (int a = 0; a < 8; ++a)
        add(f[a][0], f[a][1], f[a][2], batch.corners[a] + lane, y);
      return;
    }
#pragma GCC unroll 4
    for (int a = 0; a < 8; a += 2) {
      const V(&next)[3] = f[a + 1];
      add(f[a][0] + moved_up(next[0]), f[a][1] + moved_up(next[1]), f[a][2] + moved_up(next[2]),
          batch.corners[a] + lane, y);
      const Four last = {next[0][W - 1], next[1][W - 1], next[2][W - 1], 0};
      *reinterpret_cast<Four*>(y + batch.corners[a + 1][lane + W - 1]) += last;
    }
  }
};

} // namespace kerf::fem
