#include "fem/kernels.h"

namespace kerf::fem {

__attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default"))) void apply_stiffness(
  const ElementBlock& block, const double* const p, double* const out) {
  for (std::size_t e = 0; e < block.n; ++e) {
    const std::uint32_t* const corners = block.corners + 8 * e;
    const double* const K = block.stiffness + block.stride * block.element[e];
    const double* const R = block.rotations + 9 * e;
    alignas(64) double q[24], y[24] = {};
    for (int a = 0; a < 8; ++a) {
      const double* const pa = p + 3 * std::size_t(corners[a]);
      for (int i = 0; i < 3; ++i)
        q[3 * a + i] = R[3 * i] * pa[0] + R[3 * i + 1] * pa[1] + R[3 * i + 2] * pa[2];
    }
    for (int j = 0; j < 24; ++j)
      for (int i = 0; i < 24; ++i)
        y[i] += K[24 * j + i] * q[j];
    double* const f = out + 24 * e;
    for (int a = 0; a < 8; ++a)
      for (int i = 0; i < 3; ++i)
        f[3 * a + i] = R[i] * y[3 * a] + R[3 + i] * y[3 * a + 1] + R[6 + i] * y[3 * a + 2];
  }
}

__attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default"))) void add_mean_tangent(
  const ElementBlock& block, const double* const tangents, const double* const p, double* const out) {
  for (std::size_t e = 0; e < block.n; ++e) {
    const std::uint32_t* const corners = block.corners + 8 * e;
    const double* const b = block.gradients + block.stride * block.element[e];
    const double* const A = tangents + 81 * e;
    double G[9] = {}, P[9] = {};
    for (int a = 0; a < 8; ++a) {
      const double* const pa = p + 3 * std::size_t(corners[a]);
      for (int j = 0; j < 3; ++j)
        for (int i = 0; i < 3; ++i)
          G[3 * j + i] += pa[i] * b[3 * a + j];
    }
    for (int j = 0; j < 9; ++j)
      for (int i = 0; i < 9; ++i)
        P[i] += A[9 * j + i] * G[j];
    double* const f = out + 24 * e;
    for (int a = 0; a < 8; ++a)
      for (int i = 0; i < 3; ++i)
        f[3 * a + i] += P[i] * b[3 * a] + P[3 + i] * b[3 * a + 1] + P[6 + i] * b[3 * a + 2];
  }
}

} // namespace kerf::fem
