#pragma once

/// The loops of kernels.h for numbers T and vectors of W of them. All is inlined into functions of one instruction set
/// each, so this file is for kernels.cc alone.

#include "fem/row_loops.h"

namespace kerf::fem {

template <class T, int W>
struct ElementLoops : RowLoops<T, W> {
  using Rows = RowLoops<T, W>;
  using typename Rows::V;
  using Rows::add;
  using Rows::add_nodes;
  using Rows::load;
  using Rows::read_nodes;
  using Rows::store;

  /// Do reflections leave this pair of hourglass unknowns coupled in a full cube? Each must change the sign of both or
  /// of none.
  static constexpr bool is_coupled(const int p, const int q) {
    return (hourglass_modes[p / 3] ^ 1 << p % 3) == (hourglass_modes[q / 3] ^ 1 << q % 3);
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
  typedef float Floats __attribute__((vector_size(sizeof(float) * W)));
  [[gnu::always_inline]] static V load_floats(const float* const values) {
    return __builtin_convertvector(*reinterpret_cast<const Floats*>(values), V);
  }
  [[gnu::always_inline]] static void load_nine(const T (*const rows)[n_lanes], const int lane, V (&M)[9]) {
#pragma GCC unroll 9
    for (int i = 0; i < 9; ++i)
      M[i] = load(rows[i] + lane);
  }
  [[gnu::always_inline]] static void load_rotation(const Batch<T>& batch, const int lane, V (&R)[9]) {
#pragma GCC unroll 9
    for (int i = 0; i < 9; ++i)
      R[i] = load_floats(batch.rotation[i] + lane);
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
    if constexpr (is_partial)
      return load_floats(batch.hourglass->pair[pair] + lane);
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
    load_rotation(batch, lane, R);
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
    load_rotation(batch, lane, R);
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
    for (int lane = 0; lane < int(batch.n_used); lane += W)
      if (batch.tangent && batch.partial)
        product_law<true>(cube, batch, lane, p, y);
      else if (batch.tangent)
        product_law<false>(cube, batch, lane, p, y);
      else if (batch.partial)
        product_hooke<true>(cube, batch, lane, p, y);
      else
        product_hooke<false>(cube, batch, lane, p, y);
  }

  // --- Changes of volume -------------------------------------------------------------------------------------------

  template <bool is_partial>
  [[gnu::always_inline]] static void dilatation_of(const CubeConstants<T>& cube, const Batch<T>& batch, const int lane,
                                                   const Row<T>* const p, T* const q) {
    V c[8][3], R[9], G[9], sum = V{};
    read_modes(batch, lane, p, c);
    load_rotation(batch, lane, R);
    mean_gradient<is_partial>(cube, batch, lane, c, G);
#pragma GCC unroll 9
    for (int i = 0; i < 9; ++i)
      sum += R[i] * G[i];
    store(q + lane, sum);
  }
  [[gnu::always_inline]] static void dilatation(const CubeConstants<T>& cube, const Batch<T>& batch,
                                                const Row<T>* const p, T* const q) {
    for (int lane = 0; lane < int(n_lanes); lane += W)
      if (batch.partial)
        dilatation_of<true>(cube, batch, lane, p, q);
      else
        dilatation_of<false>(cube, batch, lane, p, q);
  }
  template <bool is_partial>
  [[gnu::always_inline]] static void add_pressure_of(const CubeConstants<T>& cube, const Batch<T>& batch,
                                                     const int lane, const T* const q, Row<T>* const y) {
    V P[9], f[8][3];
    load_rotation(batch, lane, P);
    const V pressure = load(q + lane);
#pragma GCC unroll 9
    for (int i = 0; i < 9; ++i)
      P[i] *= pressure;
#pragma GCC unroll 8
    for (int m = 0; m < 8; ++m)
#pragma GCC unroll 3
      for (int i = 0; i < 3; ++i)
        f[m][i] = V{};
    put_stress<is_partial>(cube, batch, lane, P, f);
    add_modes(f, batch, lane, y);
  }
  [[gnu::always_inline]] static void add_pressure(const CubeConstants<T>& cube, const Batch<T>& batch,
                                                  const T* const q, Row<T>* const y) {
    for (int lane = 0; lane < int(n_lanes); lane += W)
      if (batch.partial)
        add_pressure_of<true>(cube, batch, lane, q, y);
      else
        add_pressure_of<false>(cube, batch, lane, q, y);
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
    load_rotation(batch, lane, R);
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
    load_rotation(batch, lane, R);
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
      for (int lane = 0; lane < int(batch.n_used); lane += W)
        diagonal_of_full(of, batch, lane, blocks);
      return;
    }
    for (int lane = 0; lane < int(batch.n_used); lane += W)
      if (batch.partial)
        diagonal_of<true>(cube, batch, lane, blocks);
      else
        diagonal_of<false>(cube, batch, lane, blocks);
  }
};

} // namespace kerf::fem
