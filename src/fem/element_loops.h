#pragma once

/// The loops of kernels.h for numbers T and vectors of W of them. All is inlined into functions of one instruction set
/// each, so this file is for kernels.cc alone.

#include "fem/kernels.h"

#include <utility>

namespace kerf::fem {

template <class T, int W>
struct ElementLoops {
  typedef T V __attribute__((vector_size(sizeof(T) * W)));
  typedef T Four __attribute__((vector_size(sizeof(T) * 4)));

  /// Do reflections leave this pair of hourglass unknowns coupled in a full cube? Each must change the sign of both or
  /// of none.
  static constexpr bool is_coupled(const int p, const int q) {
    return (hourglass_modes[p / 3] ^ 1 << p % 3) == (hourglass_modes[q / 3] ^ 1 << q % 3);
  }

  [[gnu::always_inline]] static V load(const T* const p) { return *reinterpret_cast<const V*>(p); }
  [[gnu::always_inline]] static void store(T* const p, const V& v) { *reinterpret_cast<V*>(p) = v; }

  // --- Rows of corners ---------------------------------------------------------------------------------------------

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
  /// Reads the rows of W corners.
  [[gnu::always_inline]] static void read(const std::uint32_t* const corners, const Row<T>* const p, V (&v)[3]) {
    const V r0 = rows(p, corners), r1 = rows(p, corners + 1), r2 = rows(p, corners + 2), r3 = rows(p, corners + 3);
    const V xy01 = in_fours<0, 4, 1, 5>(r0, r1), xy23 = in_fours<0, 4, 1, 5>(r2, r3);
    const V z01 = in_fours<2, 6, 3, 7>(r0, r1), z23 = in_fours<2, 6, 3, 7>(r2, r3);
    v[0] = in_fours<0, 1, 4, 5>(xy01, xy23);
    v[1] = in_fours<2, 3, 6, 7>(xy01, xy23);
    v[2] = in_fours<0, 1, 4, 5>(z01, z23);
  }
  /// Adds to the rows of W corners, one after the other.
  [[gnu::always_inline]] static void add(const V& x, const V& y, const V& z, const std::uint32_t* const corners,
                                         Row<T>* const p, const int stride = 1) {
    const V none = {};
    const V xy01 = in_fours<0, 4, 1, 5>(x, y), xy23 = in_fours<2, 6, 3, 7>(x, y);
    const V z01 = in_fours<0, 4, 1, 5>(z, none), z23 = in_fours<2, 6, 3, 7>(z, none);
    const V of_rows[4] = {in_fours<0, 1, 4, 5>(xy01, z01), in_fours<2, 3, 6, 7>(xy01, z01),
                          in_fours<0, 1, 4, 5>(xy23, z23), in_fours<2, 3, 6, 7>(xy23, z23)};
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

  // --- Modes -------------------------------------------------------------------------------------------------------

  /// Nodes to modes, in place.
  [[gnu::always_inline]] static void to_modes(V (&c)[8][3]) {
#pragma GCC unroll 3
    for (int bit = 1; bit < 8; bit *= 2)
#pragma GCC unroll 8
      for (int a = 0; a < 8; ++a)
        if ((a & bit) == 0)
#pragma GCC unroll 3
          for (int i = 0; i < 3; ++i) {
            const V low = c[a][i], high = c[a | bit][i];
            c[a][i] = low + high;
            c[a | bit][i] = high - low;
          }
  }
  /// The transpose of that: forces on modes to forces on nodes.
  template <int n>
  [[gnu::always_inline]] static void to_nodes(V (&c)[8][n]) {
#pragma GCC unroll 3
    for (int bit = 1; bit < 8; bit *= 2)
#pragma GCC unroll 8
      for (int a = 0; a < 8; ++a)
        if ((a & bit) == 0)
#pragma GCC unroll 6
          for (int i = 0; i < n; ++i) {
            const V even = c[a][i], odd = c[a | bit][i];
            c[a][i] = even - odd;
            c[a | bit][i] = even + odd;
          }
  }
  [[gnu::always_inline]] static void read_modes(const Batch<T>& batch, const int lane, const Row<T>* const p,
                                                V (&c)[8][3]) {
    read_nodes(batch, lane, p, c);
    to_modes(c);
  }
  /// The same of positions: differences first, so that the distance from the origin is not rounded.
  [[gnu::always_inline]] static void read_shape(const Batch<T>& batch, const int lane, const Row<T>* const x,
                                                V (&c)[8][3]) {
    read_nodes(batch, lane, x, c);
#pragma GCC unroll 7
    for (int a = 7; a >= 0; --a)
#pragma GCC unroll 3
      for (int i = 0; i < 3; ++i)
        c[a][i] -= c[0][i];
    to_modes(c);
  }
  [[gnu::always_inline]] static void add_modes(V (&f)[8][3], const Batch<T>& batch, const int lane, Row<T>* const y) {
    to_nodes(f);
    add_nodes(batch, lane, f, y);
  }
  /// v = R^T v.
  [[gnu::always_inline]] static void turn_back(const V (&R)[9], V (&v)[3]) {
    const V x = v[0], y = v[1], z = v[2];
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i)
      v[i] = R[3 * i] * x + R[3 * i + 1] * y + R[3 * i + 2] * z;
  }
  /// v = R v.
  [[gnu::always_inline]] static void turn(const V (&R)[9], V (&v)[3]) {
    const V x = v[0], y = v[1], z = v[2];
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i)
      v[i] = R[i] * x + R[3 + i] * y + R[6 + i] * z;
  }
  [[gnu::always_inline]] static void load_nine(const T (*const rows)[n_lanes], const int lane, V (&M)[9]) {
#pragma GCC unroll 9
    for (int i = 0; i < 9; ++i)
      M[i] = load(rows[i] + lane);
  }

  // --- What meets modes --------------------------------------------------------------------------------------------

  /// G = sum c_m b_m^T, column by column.
  template <bool is_partial>
  [[gnu::always_inline]] static void mean_gradient(const CubeConstants<T>& cube, const Batch<T>& batch, const int lane,
                                                   const V (&c)[8][3], V (&G)[9]) {
    const T slope = T(0.25) / cube.h;
#pragma GCC unroll 3
    for (int j = 0; j < 3; ++j)
#pragma GCC unroll 3
      for (int i = 0; i < 3; ++i) {
        G[3 * j + i] = slope * c[linear_modes[j]][i];
        if constexpr (is_partial)
#pragma GCC unroll 4
          for (int k = 0; k < 4; ++k)
            G[3 * j + i] += load(batch.partial->gradient[3 * k + j] + lane) * c[hourglass_modes[k]][i];
      }
  }
  /// f_m = P b_m for the linear modes, f_m += P b_m for the others.
  template <bool is_partial>
  [[gnu::always_inline]] static void put_stress(const CubeConstants<T>& cube, const Batch<T>& batch, const int lane,
                                                const V (&P)[9], V (&f)[8][3]) {
    const T slope = T(0.25) / cube.h;
#pragma GCC unroll 3
    for (int j = 0; j < 3; ++j)
#pragma GCC unroll 3
      for (int i = 0; i < 3; ++i) {
        f[linear_modes[j]][i] = slope * P[3 * j + i];
        if constexpr (is_partial)
#pragma GCC unroll 4
          for (int k = 0; k < 4; ++k)
            f[hourglass_modes[k]][i] += load(batch.partial->gradient[3 * k + j] + lane) * P[3 * j + i];
      }
  }
  template <bool is_partial>
  [[gnu::always_inline]] static V volume(const CubeConstants<T>& cube, const Batch<T>& batch, const int lane) {
    if constexpr (is_partial)
      return load(batch.partial->volume + lane);
    else
      return cube.volume - V{};
  }
  /// V (lambda tr G I + mu (G + G^T)).
  template <bool is_partial>
  [[gnu::always_inline]] static void hooke(const CubeConstants<T>& cube, const Batch<T>& batch, const int lane,
                                           const V (&G)[9], V (&P)[9]) {
    const V v = volume<is_partial>(cube, batch, lane), mu = cube.mu * v,
            pressure = cube.lambda * v * (G[0] + G[4] + G[8]);
#pragma GCC unroll 3
    for (int j = 0; j < 3; ++j)
#pragma GCC unroll 3
      for (int i = 0; i < 3; ++i) {
        P[3 * j + i] = mu * (G[3 * j + i] + G[3 * i + j]);
        if (i == j)
          P[3 * j + i] += pressure;
      }
  }
  [[gnu::always_inline]] static void law_tangent(const Batch<T>& batch, const int lane, const V (&G)[9], V (&P)[9]) {
#pragma GCC unroll 9
    for (int i = 0; i < 9; ++i)
      P[i] = V{};
#pragma GCC unroll 9
    for (int i = 0; i < 9; ++i)
#pragma GCC unroll 9
      for (int j = 0; j <= i; ++j) {
        const V A = load(batch.tangent[pair_index(i, j)] + lane);
        P[i] += A * G[j];
        if (i != j)
          P[j] += A * G[i];
      }
  }
  template <bool is_partial>
  [[gnu::always_inline]] static V hourglass_pair(const CubeConstants<T>& cube, const Batch<T>& batch, const int lane,
                                                 const int pair) {
    typedef float Floats __attribute__((vector_size(sizeof(float) * W)));
    if constexpr (is_partial)
      return __builtin_convertvector(*reinterpret_cast<const Floats*>(batch.hourglass->pair[pair] + lane), V);
    else
      return cube.hourglass[pair] - V{};
  }
  /// f of the hourglass modes, from zero.
  template <bool is_partial>
  [[gnu::always_inline]] static void hourglass(const CubeConstants<T>& cube, const Batch<T>& batch, const int lane,
                                               const V (&c)[8][3], V (&f)[8][3]) {
#pragma GCC unroll 12
    for (int p = 0; p < n_hourglass; ++p)
      f[hourglass_modes[p / 3]][p % 3] = V{};
#pragma GCC unroll 12
    for (int p = 0; p < n_hourglass; ++p)
#pragma GCC unroll 12
      for (int q = 0; q <= p; ++q) {
        if (!is_partial && !is_coupled(p, q))
          continue;
        const V K = hourglass_pair<is_partial>(cube, batch, lane, pair_index(p, q));
        const int m = hourglass_modes[p / 3], n = hourglass_modes[q / 3];
        f[m][p % 3] += K * c[n][q % 3];
        if (p != q)
          f[n][q % 3] += K * c[m][p % 3];
      }
  }

  // --- Products ----------------------------------------------------------------------------------------------------

  template <bool is_partial>
  [[gnu::always_inline]] static void product_hooke(const CubeConstants<T>& cube, const Batch<T>& batch, const int lane,
                                                   const Row<T>* const p, Row<T>* const y) {
    V c[8][3], R[9], G[9], P[9], f[8][3];
    read_modes(batch, lane, p, c);
    load_nine(batch.rotation, lane, R);
#pragma GCC unroll 7
    for (int m = 1; m < 8; ++m)
      turn_back(R, c[m]);
    hourglass<is_partial>(cube, batch, lane, c, f);
    mean_gradient<is_partial>(cube, batch, lane, c, G);
    hooke<is_partial>(cube, batch, lane, G, P);
    put_stress<is_partial>(cube, batch, lane, P, f);
#pragma GCC unroll 7
    for (int m = 1; m < 8; ++m)
      turn(R, f[m]);
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i)
      f[0][i] = V{};
    add_modes(f, batch, lane, y);
  }
  /// The law's tangent is not turned, the hourglass modes are.
  template <bool is_partial>
  [[gnu::always_inline]] static void product_law(const CubeConstants<T>& cube, const Batch<T>& batch, const int lane,
                                                 const Row<T>* const p, Row<T>* const y) {
    V c[8][3], R[9], G[9], P[9], f[8][3];
    read_modes(batch, lane, p, c);
    load_nine(batch.rotation, lane, R);
    mean_gradient<is_partial>(cube, batch, lane, c, G);
    law_tangent(batch, lane, G, P);
#pragma GCC unroll 4
    for (int k = 0; k < 4; ++k)
      turn_back(R, c[hourglass_modes[k]]);
    hourglass<is_partial>(cube, batch, lane, c, f);
#pragma GCC unroll 4
    for (int k = 0; k < 4; ++k)
      turn(R, f[hourglass_modes[k]]);
    put_stress<is_partial>(cube, batch, lane, P, f);
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i)
      f[0][i] = V{};
    add_modes(f, batch, lane, y);
  }
  [[gnu::always_inline]] static void product(const CubeConstants<T>& cube, const Batch<T>& batch, const Row<T>* const p,
                                             Row<T>* const y) {
    for (int lane = 0; lane < int(n_lanes); lane += W)
      if (batch.tangent && batch.partial)
        product_law<true>(cube, batch, lane, p, y);
      else if (batch.tangent)
        product_law<false>(cube, batch, lane, p, y);
      else if (batch.partial)
        product_hooke<true>(cube, batch, lane, p, y);
      else
        product_hooke<false>(cube, batch, lane, p, y);
  }

  // --- Diagonal blocks ---------------------------------------------------------------------------------------------

  /// xx, yy, zz, xy, yz, zx.
  static constexpr int block_row[6] = {0, 1, 2, 0, 1, 2}, block_column[6] = {0, 1, 2, 1, 2, 0};

  /// Of the hourglass modes, in the turned frame: sums over pairs of modes by their product, which is a mode again.
  template <bool is_partial>
  [[gnu::always_inline]] static void hourglass_blocks(const CubeConstants<T>& cube, const Batch<T>& batch,
                                                      const int lane, V (&D)[8][6]) {
    for (int m = 0; m < 8; ++m)
      for (int ij = 0; ij < 6; ++ij)
        D[m][ij] = V{};
    for (int k = 0; k < 4; ++k)
      for (int l = 0; l < 4; ++l)
        for (int ij = 0; ij < 6; ++ij) {
          const int p = 3 * k + block_row[ij], q = 3 * l + block_column[ij],
                    pair = p > q ? pair_index(p, q) : pair_index(q, p);
          D[hourglass_modes[k] ^ hourglass_modes[l]][ij] += hourglass_pair<is_partial>(cube, batch, lane, pair);
        }
    to_nodes(D);
  }
  /// b_a of the mean gradient.
  template <bool is_partial>
  [[gnu::always_inline]] static void node_gradient(const CubeConstants<T>& cube, const Batch<T>& batch, const int lane,
                                                   const int a, V (&b)[3]) {
    const T slope = T(0.25) / cube.h;
    for (int j = 0; j < 3; ++j) {
      b[j] = (a >> j & 1 ? slope : -slope) - V{};
      if constexpr (is_partial)
        for (int k = 0; k < 4; ++k) {
          const V part = load(batch.partial->gradient[3 * k + j] + lane);
          const bool is_odd = __builtin_popcount(hourglass_modes[k] & ~a) & 1;
          b[j] += is_odd ? -part : part;
        }
    }
  }
  [[gnu::always_inline]] static V tangent_entry(const Batch<T>& batch, const int lane, const int i, const int j) {
    return load(batch.tangent[i > j ? pair_index(i, j) : pair_index(j, i)] + lane);
  }
  [[gnu::always_inline]] static void turn_block(const V (&R)[9], V (&D)[6]) {
    const V full[3][3] = {{D[0], D[3], D[5]}, {D[3], D[1], D[4]}, {D[5], D[4], D[2]}};
    V RD[3][3];
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        RD[i][j] = R[i] * full[0][j] + R[3 + i] * full[1][j] + R[6 + i] * full[2][j];
    for (int ij = 0; ij < 6; ++ij) {
      const int i = block_row[ij], j = block_column[ij];
      D[ij] = RD[i][0] * R[j] + RD[i][1] * R[3 + j] + RD[i][2] * R[6 + j];
    }
  }
  template <bool is_partial>
  [[gnu::always_inline]] static void diagonal_of(const CubeConstants<T>& cube, const Batch<T>& batch, const int lane,
                                                 Row<T>* const blocks) {
    V D[8][6], R[9], b[3] = {V{}, V{}, V{}};
    hourglass_blocks<is_partial>(cube, batch, lane, D);
    load_nine(batch.rotation, lane, R);
    const V v = volume<is_partial>(cube, batch, lane);
    for (int a = 0; a < 8; ++a) {
      node_gradient<is_partial>(cube, batch, lane, a, b);
      if (!batch.tangent)
        for (int ij = 0; ij < 6; ++ij) {
          const int i = block_row[ij], j = block_column[ij];
          D[a][ij] += (cube.lambda + cube.mu) * v * b[i] * b[j];
          if (i == j)
            D[a][ij] += cube.mu * v * (b[0] * b[0] + b[1] * b[1] + b[2] * b[2]);
        }
      turn_block(R, D[a]);
      if (batch.tangent)
        for (int ij = 0; ij < 6; ++ij)
          for (int j = 0; j < 3; ++j)
            for (int l = 0; l < 3; ++l)
              D[a][ij] += b[j] * b[l] * tangent_entry(batch, lane, 3 * j + block_row[ij], 3 * l + block_column[ij]);
      if constexpr (is_partial)
        for (V& d : D[a])
          d *= load(batch.partial->weight + lane);
      add(D[a][0], D[a][1], D[a][2], batch.corners[a] + lane, blocks, 2);
      add(D[a][3], D[a][4], D[a][5], batch.corners[a] + lane, blocks + 1, 2);
    }
  }
  /// Of a full cube that meets Hooke's law the block of a node with the signs s is R (diag(d) + sum over pairs i, j of
  /// s_i s_j o_ij (e_i e_j^T + e_j e_i^T)) R^T: two opposite nodes have the same.
  struct FullBlocks {
    T d[3], o[3]; ///< o of the pairs 01, 12, 20
  };
  [[gnu::always_inline]] static FullBlocks full_blocks(const CubeConstants<T>& cube) {
    const T mean = cube.volume / (16 * cube.h * cube.h);
    FullBlocks blocks;
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3;
      blocks.d[i] = mean * (cube.lambda + 4 * cube.mu);
      blocks.o[i] = mean * (cube.lambda + cube.mu);
      for (int k = 0; k < 4; ++k)
        for (int l = 0; l < 4; ++l) {
          const int p = 3 * k + i, q = 3 * l + j;
          if (k == l)
            blocks.d[i] += cube.hourglass[pair_index(p, p)];
          if (is_coupled(p, q))
            blocks.o[i] += cube.hourglass[p > q ? pair_index(p, q) : pair_index(q, p)];
        }
    }
    return blocks;
  }
  [[gnu::always_inline]] static void diagonal_of_full(const FullBlocks& of, const Batch<T>& batch, const int lane,
                                                      Row<T>* const blocks) {
    V R[9], same[6], pair[3][6];
    load_nine(batch.rotation, lane, R);
#pragma GCC unroll 6
    for (int ij = 0; ij < 6; ++ij) {
      const int i = block_row[ij], j = block_column[ij];
      same[ij] = of.d[0] * R[i] * R[j] + of.d[1] * R[3 + i] * R[3 + j] + of.d[2] * R[6 + i] * R[6 + j];
#pragma GCC unroll 3
      for (int p = 0; p < 3; ++p) {
        const int q = (p + 1) % 3;
        pair[p][ij] = of.o[p] * (R[3 * p + i] * R[3 * q + j] + R[3 * q + i] * R[3 * p + j]);
      }
    }
#pragma GCC unroll 4
    for (int a = 0; a < 4; ++a) {
      V D[6];
#pragma GCC unroll 6
      for (int ij = 0; ij < 6; ++ij) {
        D[ij] = same[ij];
#pragma GCC unroll 3
        for (int p = 0; p < 3; ++p)
          D[ij] += (a >> p & 1) == (a >> (p + 1) % 3 & 1) ? pair[p][ij] : -pair[p][ij];
      }
#pragma GCC unroll 2
      for (const int node : {a, 7 - a}) {
        add(D[0], D[1], D[2], batch.corners[node] + lane, blocks, 2);
        add(D[3], D[4], D[5], batch.corners[node] + lane, blocks + 1, 2);
      }
    }
  }
  [[gnu::always_inline]] static void diagonal(const CubeConstants<T>& cube, const Batch<T>& batch,
                                              Row<T>* const blocks) {
    if (!batch.partial && !batch.tangent) {
      const FullBlocks of = full_blocks(cube);
      for (int lane = 0; lane < int(n_lanes); lane += W)
        diagonal_of_full(of, batch, lane, blocks);
      return;
    }
    for (int lane = 0; lane < int(n_lanes); lane += W)
      if (batch.partial)
        diagonal_of<true>(cube, batch, lane, blocks);
      else
        diagonal_of<false>(cube, batch, lane, blocks);
  }
};

} // namespace kerf::fem
