/// Rotations of elements out of the cache, for strains of a part: gathering eight corners of one cube each, mean
/// gradients, polar decompositions and storing them. Medians of CPU time, one thread.

#include "fem/batches.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <ctime>
#include <numeric>
#include <vector>

namespace kerf::fem {
namespace {

constexpr double h = 0.25;
const material::Elastic rubber{.density = 1000, .youngs_modulus = 1e5, .poissons_ratio = 0.3};

double cpu_time() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// One batch of cubes that share no corner.
struct CubesApart {
  CubesApart() {
    const Element full = make_element(full_cube_moments(), h, rubber, {});
    const std::vector<Kind> kinds(n_lanes, Kind::full);
    std::vector<std::uint32_t> order(n_lanes), corners(8 * n_lanes);
    std::iota(order.begin(), order.end(), 0);
    std::iota(corners.begin(), corners.end(), 0);
    const std::array<std::uint32_t, 1> ends = {n_lanes};
    batching = Batching({order, ends, kinds, corners.data(), 8 * n_lanes});
    batched = fem::batched<double>(batching, h, rubber, full, {[&](std::uint32_t) -> const Element& { return full; }});
  }
  Batching batching;
  BatchedElements<double> batched;
};

void measure(const double strain) {
  constexpr int n_calls = 20000, n_runs = 9;
  const CubesApart cubes;
  std::vector<Row<double>> x(cubes.batching.n_rows());
  for (std::size_t e = 0; e < n_lanes; ++e) {
    const Mat3 F = Mat3::Identity() + strain * Mat3::Random();
    for (int a = 0; a < 8; ++a) {
      const Vec3 at = F * (h * Vec3(a & 1, a >> 1 & 1, a >> 2 & 1));
      x[8 * e + a] = {at[0], at[1], at[2]};
    }
  }
  const auto batch = cubes.batched.batch(cubes.batching, 0);
  Turns turns{};
  std::vector<double> seconds;
  unsigned n_unknown = 0;
  for (int run = 0; run < n_runs; ++run) {
    const double start = cpu_time();
    for (int i = 0; i < n_calls; ++i)
      n_unknown |= force_kernels().turn(cubes.batched.cube, batch, x.data(), turns);
    seconds.push_back(cpu_time() - start);
  }
  std::nth_element(seconds.begin(), seconds.begin() + n_runs / 2, seconds.end());
  std::printf("| %g | %.1f | %s |\n", strain, 1e-6 * n_calls * n_lanes / seconds[n_runs / 2],
              n_unknown == 0 ? "all found" : "some not found");
}

} // namespace
} // namespace kerf::fem

int main() {
  std::printf("| strain | million rotations/s | |\n|---|---|---|\n");
  for (const double strain : {0.001, 0.02, 0.1, 0.3})
    kerf::fem::measure(strain);
}
