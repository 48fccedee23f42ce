#pragma once

/// The loops of kernels.h for rotations, forces and energies (turned.h), beside those of element_loops.h. For
/// kernels.cc alone.

#include "fem/element_loops.h"

#include <bit>

namespace kerf::fem {

template <class T, int W>
struct ForceLoops : ElementLoops<T, W> {
  using Loops = ElementLoops<T, W>;
  using Loops::add_modes;
  using Loops::load;
  using Loops::load_nine;
  using Loops::read_shape;
  using Loops::store;
  using Loops::turn;
  using Loops::turn_back;
  using typename Loops::V;

  /// Vectors of a batch, and how many of them have lanes that are used.
  static constexpr int n_vectors = int(n_lanes) / W;
  [[gnu::always_inline]] static int n_used_vectors(const Batch<T>& batch) { return (int(batch.n_used) + W - 1) / W; }

  // --- Rotations ---------------------------------------------------------------------------------------------------

  /// R^-T times its determinant, which is returned.
  [[gnu::always_inline]] static V cofactors(const V (&R)[9], V (&C)[9]) {
#pragma GCC unroll 3
    for (int j = 0; j < 3; ++j)
#pragma GCC unroll 3
      for (int i = 0; i < 3; ++i) {
        const int j1 = (j + 1) % 3, j2 = (j + 2) % 3, i1 = (i + 1) % 3, i2 = (i + 2) % 3;
        C[3 * j + i] = R[3 * j1 + i1] * R[3 * j2 + i2] - R[3 * j1 + i2] * R[3 * j2 + i1];
      }
    return R[0] * C[0] + R[1] * C[1] + R[2] * C[2];
  }
  /// F = R S in each lane, by the trace s of S: the largest root of (s^2 - I)^2 - 4 II - 8 J s with I = |F|^2,
  /// II = |cof F|^2 and J = det F (Hoger and Carlson 1984, Determination of the stretch and rotation in the polar
  /// decomposition of the deformation gradient). R = ds/dF, as s is the largest value of tr R^T F. The root is found by
  /// Halley's iteration from (I + 3) / 2, which is not below it, and off by squares of strain alone: two steps with
  /// strains of a per cent, three with .3.
  struct Stretch {
    V I, II, J, trace;
  };
  [[gnu::always_inline]] static void find_invariants(const V (&F)[9], Stretch& S) {
    V C[9], I[3], II[3];
    S.J = cofactors(F, C);
#pragma GCC unroll 3
    for (int j = 0; j < 3; ++j) {
      I[j] = F[3 * j] * F[3 * j] + F[3 * j + 1] * F[3 * j + 1] + F[3 * j + 2] * F[3 * j + 2];
      II[j] = C[3 * j] * C[3 * j] + C[3 * j + 1] * C[3 * j + 1] + C[3 * j + 2] * C[3 * j + 2];
    }
    S.I = I[0] + I[1] + I[2];
    S.II = II[0] + II[1] + II[2];
  }
  /// Of n vectors side by side: each step waits for the one before, and those of other vectors fill the time.
  template <int n>
  [[gnu::always_inline]] static void find_traces(Stretch* const S) {
    constexpr int most = 8;
    constexpr T stands = T(3e-6); // one more step would cube that
    V s[n];
    decltype(S->I != S->I) is_done[n];
#pragma GCC unroll 8
    for (int g = 0; g < n; ++g) {
      s[g] = T(0.5) * (S[g].I + T(3));
      is_done[g] = S[g].I == V{}; // lanes that are not used
    }
    for (int k = 0; k < most; ++k) {
      auto all = is_done[0] | ~is_done[0];
#pragma GCC unroll 8
      for (int g = 0; g < n; ++g) {
        const V a = s[g] * s[g] - S[g].I, f = a * a - 4 * S[g].II - 8 * S[g].J * s[g],
                df = 4 * s[g] * a - 8 * S[g].J, ddf = 12 * s[g] * s[g] - 4 * S[g].I,
                step = 2 * f * df / (2 * df * df - f * ddf);
        s[g] = is_done[g] ? s[g] : s[g] - step;
        is_done[g] |= step * step < stands * stands * s[g] * s[g];
        all &= is_done[g];
      }
      bool is_all = true;
      for (int l = 0; l < W; ++l)
        is_all &= all[l] != 0;
      if (is_all)
        break;
    }
#pragma GCC unroll 8
    for (int g = 0; g < n; ++g)
      S[g].trace = s[g];
  }
  /// Of all lanes of a batch that are used.
  [[gnu::always_inline]] static void find_traces(const int n, Stretch (&S)[n_vectors]) {
    if (n == n_vectors)
      find_traces<n_vectors>(S);
    else
      for (int g = 0; g < n; ++g)
        find_traces<1>(S + g);
  }
  /// R by the trace. Returns bits of lanes where it is no rotation to 1e-12, by its norm, or F is near singular or
  /// inverted.
  [[gnu::always_inline]] static unsigned nearest_rotation(const V (&F)[9], const Stretch& S, V (&R)[9]) {
    constexpr T well_conditioned = T(1e-5), is_rotation = T(1e-12);
    V C[9], B[9], square[3];
    cofactors(F, C);
    const V s = S.trace, a = s * s - S.I, scale = T(1) / (s * a - 2 * S.J), of_F = (s * s + S.I) * scale,
            of_C = 2 * s * scale, of_S = -2 * scale;
#pragma GCC unroll 3
    for (int j = 0; j < 3; ++j)
#pragma GCC unroll 3
      for (int k = 0; k <= j; ++k) // F^T F
        B[3 * j + k] = B[3 * k + j] = F[3 * k] * F[3 * j] + F[3 * k + 1] * F[3 * j + 1] + F[3 * k + 2] * F[3 * j + 2];
#pragma GCC unroll 3
    for (int j = 0; j < 3; ++j) {
#pragma GCC unroll 3
      for (int i = 0; i < 3; ++i)
        R[3 * j + i] = of_F * F[3 * j + i] + of_C * C[3 * j + i] +
                       of_S * (F[i] * B[3 * j] + F[3 + i] * B[3 * j + 1] + F[6 + i] * B[3 * j + 2]);
      square[j] = R[3 * j] * R[3 * j] + R[3 * j + 1] * R[3 * j + 1] + R[3 * j + 2] * R[3 * j + 2];
    }
    const V off = square[0] + square[1] + square[2] - T(3);
    const auto is_found = (off * off < is_rotation * is_rotation) & (S.J > 0) &
                          (S.J * S.J * 27 > well_conditioned * well_conditioned * S.I * S.I * S.I);
    unsigned unknown = 0;
    for (int l = 0; l < W; ++l)
      unknown |= unsigned(is_found[l] == 0) << l;
    return unknown;
  }
  template <bool is_partial>
  [[gnu::always_inline]] static unsigned turn_batch(const CubeConstants<T>& cube, const Batch<T>& batch,
                                                    const Row<T>* const x, Turns& turns) {
    Stretch S[n_vectors];
    const int n = n_used_vectors(batch);
    for (int g = 0; g < n; ++g) {
      V c[8][3], F[9];
      read_shape(batch, g * W, x, c);
      Loops::template mean_gradient<is_partial>(cube, batch, g * W, c, F);
      find_invariants(F, S[g]);
#pragma GCC unroll 9
      for (int i = 0; i < 9; ++i)
        store(turns.F[i] + g * W, F[i]);
    }
    find_traces(n, S);
    unsigned unknown = 0;
    for (int g = 0; g < n; ++g) {
      V F[9], R[9];
      load_nine(turns.F, g * W, F);
      unknown |= nearest_rotation(F, S[g], R) << g * W;
#pragma GCC unroll 9
      for (int i = 0; i < 9; ++i)
        store(turns.R[i] + g * W, R[i]);
    }
    for (int g = n; g < n_vectors; ++g)
#pragma GCC unroll 9
      for (int i = 0; i < 9; ++i) {
        store(turns.F[i] + g * W, V{});
        store(turns.R[i] + g * W, V{});
      }
    return unknown;
  }
  [[gnu::always_inline]] static unsigned turn_all(const CubeConstants<T>& cube, const Batch<T>& batch,
                                                  const Row<T>* const x, Turns& turns) {
    return batch.partial ? turn_batch<true>(cube, batch, x, turns) : turn_batch<false>(cube, batch, x, turns);
  }

  // --- Forces ------------------------------------------------------------------------------------------------------

  /// a x b.
  [[gnu::always_inline]] static void cross(const V (&a)[3], const V (&b)[3], V (&c)[3]) {
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i)
      c[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
  }
  /// What a shape has to say in its turned frame.
  struct Strained {
    V u[8][3]; ///< R^T c_m - 4 h, of modes
    V f[8][3]; ///< dE/du_m
    V t[3];    ///< torque of the hourglass modes; the mean stress has none, as it commutes with the stretch
    V G[9];    ///< R^T F - 1
  };
  /// Of a shape in s.u.
  template <bool is_partial, MeanPart mean>
  [[gnu::always_inline]] static void strain(const CubeConstants<T>& cube, const Batch<T>& batch, const int lane,
                                            const V (&R)[9], Strained& s) {
    V P[9], w[3];
#pragma GCC unroll 7
    for (int m = 1; m < 8; ++m)
      turn_back(R, s.u[m]);
#pragma GCC unroll 3
    for (int k = 0; k < 3; ++k)
      s.u[linear_modes[k]][k] -= 4 * cube.h;
    Loops::template hourglass<is_partial>(cube, batch, lane, s.u, s.f);
    cross(s.u[hourglass_modes[0]], s.f[hourglass_modes[0]], s.t);
#pragma GCC unroll 3
    for (int k = 1; k < 4; ++k) {
      cross(s.u[hourglass_modes[k]], s.f[hourglass_modes[k]], w);
#pragma GCC unroll 3
      for (int i = 0; i < 3; ++i)
        s.t[i] += w[i];
    }
    Loops::template mean_gradient<is_partial>(cube, batch, lane, s.u, s.G);
    if constexpr (mean == MeanPart::hooke) {
      Loops::template hooke<is_partial>(cube, batch, lane, s.G, P);
    } else {
#pragma GCC unroll 9
      for (int i = 0; i < 9; ++i)
        P[i] = V{};
    }
    Loops::template put_stress<is_partial>(cube, batch, lane, P, s.f);
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i)
      s.f[0][i] = V{};
  }
  /// z with A z = t, A = tr(S) I - S and S = 1 + G, which is symmetric; zero where A has collapsed (turned.h).
  [[gnu::always_inline]] static void spin(const V (&G)[9], const V (&t)[3], V (&z)[3]) {
    constexpr T collapsed = T(1e-6);
    const V trace = G[0] + G[4] + G[8] + T(2);
    const V xx = trace - G[0], yy = trace - G[4], zz = trace - G[8]; // of A
    const V xy = T(-0.5) * (G[3] + G[1]), yz = T(-0.5) * (G[7] + G[5]), zx = T(-0.5) * (G[2] + G[6]);
    const V of_xx = yy * zz - yz * yz, of_yy = zz * xx - zx * zx, of_zz = xx * yy - xy * xy; // cofactors
    const V of_xy = yz * zx - xy * zz, of_yz = zx * xy - yz * xx, of_zx = xy * yz - zx * yy;
    const V det = xx * of_xx + xy * of_xy + zx * of_zx, inverse = T(1) / det;
    const auto is_sound = det > collapsed;
    const V value[3] = {of_xx * t[0] + of_xy * t[1] + of_zx * t[2], of_xy * t[0] + of_yy * t[1] + of_yz * t[2],
                        of_zx * t[0] + of_yz * t[1] + of_zz * t[2]};
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i)
      z[i] = is_sound ? value[i] * inverse : V{};
  }
  /// E = u.f / 2.
  [[gnu::always_inline]] static V half_product(const Strained& s) {
    V sum = V{};
#pragma GCC unroll 7
    for (int m = 1; m < 8; ++m)
#pragma GCC unroll 3
      for (int i = 0; i < 3; ++i)
        sum += s.u[m][i] * s.f[m][i];
    return T(0.5) * sum;
  }
  /// forces -= dE/dx, with dR/dx times `spins`.
  template <bool is_partial>
  [[gnu::always_inline]] static void add_force(const CubeConstants<T>& cube, const Batch<T>& batch, const int lane,
                                               const V (&R)[9], const T (*const stress)[n_lanes], const T spins,
                                               Strained& s, Row<T>* const forces) {
    V z[3], w[3], minus[9];
    spin(s.G, s.t, z);
    for (V& component : z)
      component *= spins;
#pragma GCC unroll 3
    for (int k = 0; k < 3; ++k) { // z x e_k / (4 h)
      const int next = (k + 1) % 3, after = (k + 2) % 3;
      s.f[linear_modes[k]][next] -= T(0.25) / cube.h * z[after];
      s.f[linear_modes[k]][after] += T(0.25) / cube.h * z[next];
    }
    if constexpr (is_partial)
#pragma GCC unroll 4
      for (int k = 0; k < 4; ++k) {
        const V b[3] = {load(batch.partial->gradient[3 * k] + lane), load(batch.partial->gradient[3 * k + 1] + lane),
                        load(batch.partial->gradient[3 * k + 2] + lane)};
        cross(z, b, w);
#pragma GCC unroll 3
        for (int i = 0; i < 3; ++i)
          s.f[hourglass_modes[k]][i] -= w[i];
      }
#pragma GCC unroll 9
    for (int i = 0; i < 9; ++i)
      minus[i] = -R[i];
#pragma GCC unroll 7
    for (int m = 1; m < 8; ++m)
      turn(minus, s.f[m]);
    if (stress) {
      V P[9];
      load_nine(stress, lane, P);
#pragma GCC unroll 3
      for (int j = 0; j < 3; ++j)
#pragma GCC unroll 3
        for (int i = 0; i < 3; ++i) {
          s.f[linear_modes[j]][i] -= T(0.25) / cube.h * P[3 * j + i];
          if constexpr (is_partial)
#pragma GCC unroll 4
            for (int k = 0; k < 4; ++k)
              s.f[hourglass_modes[k]][i] -= load(batch.partial->gradient[3 * k + j] + lane) * P[3 * j + i];
        }
    }
    add_modes(s.f, batch, lane, forces);
  }
  template <bool is_partial, MeanPart mean>
  [[gnu::always_inline]] static void force_of(const CubeConstants<T>& cube, const Batch<T>& batch, const int lane,
                                              const Turns& turns, const T (*const stress)[n_lanes], const T spins,
                                              const Row<T>* const x, Row<T>* const forces, T* const energies) {
    V R[9];
    Strained s;
    load_nine(turns.R, lane, R);
    read_shape(batch, lane, x, s.u);
    strain<is_partial, mean>(cube, batch, lane, R, s);
    if (energies)
      store(energies + lane, half_product(s));
    add_force<is_partial>(cube, batch, lane, R, stress, spins, s, forces);
  }
  /// R of those lanes that nearest_rotation() leaves open.
  [[gnu::noinline]] static void find_rotations(const FindRotation find, unsigned unknown, const V (&F)[9], V (&R)[9]) {
    for (; unknown != 0; unknown &= unknown - 1) {
      const int l = std::countr_zero(unknown);
      T of_lane[9], found[9];
      for (int i = 0; i < 9; ++i)
        of_lane[i] = F[i][l];
      find(of_lane, found);
      for (int i = 0; i < 9; ++i)
        R[i][l] = found[i];
    }
  }
  /// What the first loop over a batch leaves to the second.
  struct Shape {
    V c[7][3]; ///< of modes, but for the mean
    V F[9];
  };
  template <bool is_partial>
  [[gnu::always_inline]] static void turned_force_of(const CubeConstants<T>& cube, const Batch<T>& batch,
                                                     const FindRotation find, const Row<T>* const x,
                                                     Row<T>* const forces, T* const energies) {
    Shape shapes[n_vectors];
    Stretch S[n_vectors];
    const int n = n_used_vectors(batch);
    for (int g = 0; g < n; ++g) {
      V c[8][3];
      read_shape(batch, g * W, x, c);
      Loops::template mean_gradient<is_partial>(cube, batch, g * W, c, shapes[g].F);
      find_invariants(shapes[g].F, S[g]);
#pragma GCC unroll 7
      for (int m = 1; m < 8; ++m)
#pragma GCC unroll 3
        for (int i = 0; i < 3; ++i)
          shapes[g].c[m - 1][i] = c[m][i];
    }
    find_traces(n, S);
    const unsigned used = (1U << batch.n_used) - 1;
    for (int g = 0; g < n; ++g) {
      V R[9];
      Strained s;
      if (const unsigned unknown = nearest_rotation(shapes[g].F, S[g], R) & used >> g * W; unknown != 0)
        find_rotations(find, unknown, shapes[g].F, R);
#pragma GCC unroll 7
      for (int m = 1; m < 8; ++m)
#pragma GCC unroll 3
        for (int i = 0; i < 3; ++i)
          s.u[m][i] = shapes[g].c[m - 1][i];
      strain<is_partial, MeanPart::hooke>(cube, batch, g * W, R, s);
      store(energies + g * W, half_product(s));
      add_force<is_partial>(cube, batch, g * W, R, nullptr, T(1), s, forces);
    }
  }
  [[gnu::always_inline]] static void turned_force(const CubeConstants<T>& cube, const Batch<T>& batch,
                                                  const FindRotation find, const Row<T>* const x, Row<T>* const forces,
                                                  T* const energies) {
    if (batch.partial)
      turned_force_of<true>(cube, batch, find, x, forces, energies);
    else
      turned_force_of<false>(cube, batch, find, x, forces, energies);
  }
  [[gnu::always_inline]] static void force(const CubeConstants<T>& cube, const Batch<T>& batch, const Turns& turns,
                                           const MeanPart mean, const T (*const stress)[n_lanes], const T spins,
                                           const Row<T>* const x, Row<T>* const forces, T* const energies) {
    for (int lane = 0; lane < int(batch.n_used); lane += W)
      if (batch.partial && mean == MeanPart::hooke)
        force_of<true, MeanPart::hooke>(cube, batch, lane, turns, stress, spins, x, forces, energies);
      else if (batch.partial)
        force_of<true, MeanPart::none>(cube, batch, lane, turns, stress, spins, x, forces, energies);
      else if (mean == MeanPart::hooke)
        force_of<false, MeanPart::hooke>(cube, batch, lane, turns, stress, spins, x, forces, energies);
      else
        force_of<false, MeanPart::none>(cube, batch, lane, turns, stress, spins, x, forces, energies);
  }
  template <bool is_partial, MeanPart mean>
  [[gnu::always_inline]] static V energy_of(const CubeConstants<T>& cube, const Batch<T>& batch, const int lane,
                                            const Turns& turns, const Row<T>* const x) {
    V R[9];
    Strained s;
    load_nine(turns.R, lane, R);
    read_shape(batch, lane, x, s.u);
    strain<is_partial, mean>(cube, batch, lane, R, s);
    return half_product(s);
  }
  [[gnu::always_inline]] static void energy(const CubeConstants<T>& cube, const Batch<T>& batch, const Turns& turns,
                                            const MeanPart mean, const Row<T>* const x, T* const energies) {
    for (int lane = 0; lane < int(batch.n_used); lane += W)
      if (batch.partial && mean == MeanPart::hooke)
        store(energies + lane, energy_of<true, MeanPart::hooke>(cube, batch, lane, turns, x));
      else if (batch.partial)
        store(energies + lane, energy_of<true, MeanPart::none>(cube, batch, lane, turns, x));
      else if (mean == MeanPart::hooke)
        store(energies + lane, energy_of<false, MeanPart::hooke>(cube, batch, lane, turns, x));
      else
        store(energies + lane, energy_of<false, MeanPart::none>(cube, batch, lane, turns, x));
  }
};

} // namespace kerf::fem
