/// The kernels of full cubes (fem/kernels.h) out of the cache, on one batch of cubes that share no corner: rotations
/// with gathering eight corners of one cube each, mean gradients and storing, for strains of a part; products and forces
/// with gathering and adding to corners. The least of many runs, one thread.

#include "fem/batches.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <numeric>
#include <vector>

namespace kerf::fem {
namespace {

constexpr double h = 0.25;
const material::Elastic rubber{.density = 1000, .youngs_modulus = 1e5, .poissons_ratio = 0.3};

template <class T>
struct CubesApart {
  CubesApart() {
    const Element full = make_element(full_cube_moments(), h, rubber, {});
    const std::vector<Kind> kinds(n_lanes, Kind::full);
    std::vector<std::uint32_t> order(n_lanes), corners(8 * n_lanes);
    std::iota(order.begin(), order.end(), 0);
    std::iota(corners.begin(), corners.end(), 0);
    const std::array<std::uint32_t, 1> ends = {n_lanes};
    batching = Batching({order, ends, kinds, corners.data(), 8 * n_lanes});
    batched = fem::batched<T>(batching, h, rubber, full, {[&](std::uint32_t) -> const Element& { return full; }});
  }
  std::vector<Row<T>> deformed(const double strain) const {
    std::vector<Row<T>> x(batching.n_rows());
    for (std::size_t e = 0; e < n_lanes; ++e) {
      const Mat3 F = Mat3::Identity() + strain * Mat3::Random();
      for (int a = 0; a < 8; ++a) {
        const Vec3 at = F * (h * Vec3(a & 1, a >> 1 & 1, a >> 2 & 1));
        x[8 * e + a] = {T(at[0]), T(at[1]), T(at[2])};
      }
    }
    return x;
  }
  Batch<T> batch() const { return batched.batch(batching, 0); }

  Batching batching;
  BatchedElements<T> batched;
};

template <class Call>
void measure(const char* const name, const Call& call) {
  using Clock = std::chrono::steady_clock;
  constexpr int n_calls = 2000, n_runs = 300;
  double least = 1e300;
  for (int run = 0; run < n_runs; ++run) {
    const auto start = Clock::now();
    for (int i = 0; i < n_calls; ++i)
      call();
    least = std::min(least, std::chrono::duration<double>(Clock::now() - start).count());
  }
  std::printf("| %s | %.1f |\n", name, 1e-6 * n_calls * n_lanes / least);
}

template <class T>
void measure_products(const char* const name) {
  const CubesApart<T> cubes;
  const std::vector<Row<T>> p = cubes.deformed(0.1);
  std::vector<Row<T>> y(p.size());
  const auto batch = cubes.batch();
  measure(name, [&] { element_kernels<T>().product(cubes.batched.cube, batch, p.data(), y.data()); });
}

} // namespace
} // namespace kerf::fem

int main() {
  using namespace kerf::fem;
  std::printf("| kernel | million elements/s |\n|---|---|\n");
  const CubesApart<double> cubes;
  const auto batch = cubes.batch();
  Turns turns{};
  for (const auto& [strain, name] : {std::pair(0.001, "rotations, strain .001"), std::pair(0.02, "rotations, .02"),
                                     std::pair(0.1, "rotations, .1"), std::pair(0.3, "rotations, .3")}) {
    const auto x = cubes.deformed(strain);
    measure(name, [&] { force_kernels().turn(cubes.batched.cube, batch, x.data(), turns); });
  }
  measure_products<double>("products, double precision");
  measure_products<float>("products, single precision");
  const auto x = cubes.deformed(0.02);
  std::vector<Row<double>> forces(x.size());
  alignas(64) std::array<double, n_lanes> energies;
  const FindRotation none = [](const double*, double*) {};
  measure("forces and energies, with rotations", [&] {
    force_kernels().turned_force(cubes.batched.cube, batch, none, x.data(), forces.data(), energies.data());
  });
}
