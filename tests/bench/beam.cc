/// Implicit Euler on a cantilever of 1 x 0.2 x 0.2 m with its skin at half cells: E = 1e5 Pa, 1000 kg/m^3, g = 0.981
/// m/s^2, mass damping 2/s, steps of 1/60 s to 1e-6. Seconds a step (median) and iterations, for cells over its
/// height and Poisson's ratio as given: bench_beam CELLS [NU [CUTS [THREADS]]], CUTS = slits into it from above. Then
/// what follows a cut of its middle layer: the model's update, and by how much the next step takes longer.

#include "base/parallel.h"
#include "dynamics/implicit_euler.h"
#include "fem/hexahedra.h"
#include "tests/fem/bodies.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>

namespace kerf::fem {
namespace {

/// Of the processor with one thread, else of the clock.
double seconds_now() {
  timespec now{};
  clock_gettime(n_threads() == 1 ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Cells with skin at half of them, so n - 1 nodes over the height.
Body beam(const int n, const int n_slits) {
  const double h = 0.2 / (n - 1);
  Index3 size = {5 * (n - 1), n - 1, n - 1};
  std::vector<Index3> nodes;
  for (int k = 0; k < size[2]; ++k)
    for (int j = 0; j < size[1]; ++j)
      for (int i = 0; i < size[0]; ++i)
        nodes.push_back({1 + i, 1 + j, 1 + k});
  grid::Grid grid({Vec3::Constant(-0.5 * h), h}, nodes);
  grid::Cuts cuts(grid);
  Body body{{std::move(grid), std::move(cuts)}};
  std::vector<grid::EdgeCut> all;
  for (const auto e : ids<grid::EdgeId>(body.grid.n_edges())) {
    const auto [lower, upper] = body.grid.ends(e);
    const int axis = body.grid.axis(e);
    const Index3 at = body.grid.index(lower);
    if (body.grid.is_material(lower) != body.grid.is_material(upper))
      all.push_back({e, 0.5, (body.grid.is_material(lower) ? 1 : -1) * Vec3::Unit(axis), grid::skin_label});
    else if (axis == 0 && body.grid.is_material(lower) && n_slits > 0 && at[0] % (size[0] / (n_slits + 1)) == 0 &&
             at[2] > size[2] / 3 && at[0] < size[0])
      all.push_back({e, 0.3, Vec3::UnitX(), 1});
  }
  body.cut(all);
  return body;
}

void run(const int n, const double nu, const int n_slits) {
  const Body body = beam(n, n_slits);
  const Points rest = body.rest();
  const double start = seconds_now();
  Hexahedra model(body, {.material = {.density = 1000, .youngs_modulus = 1e5, .poissons_ratio = nu}});
  const double built = seconds_now() - start;
  dynamics::Loads loads;
  loads.gravity = Vec3(0, 0, -0.981);
  loads.mass_damping = 2;
  dynamics::Support clamp{.corners = {}, .rest = {}, .displacement = [](double) { return Vec3(Vec3::Zero()); }};
  for (std::uint32_t c = 0; c < rest.size(); ++c)
    if (rest[c][0] < 0.6 * model.h()) {
      clamp.corners.push_back(c);
      clamp.rest.push_back(rest[c]);
    }
  loads.supports.push_back(clamp);
  dynamics::ImplicitEuler stepper(model, {});
  dynamics::State state{rest, Points(rest.size(), Vec3::Zero())};
  const int n_steps = model.n_elements() > 50000 ? 5 : 9;
  std::vector<double> seconds;
  std::vector<int> iterations;
  for (int s = 0; s < n_steps; ++s) {
    const double before = seconds_now();
    iterations.push_back(stepper.step(state, loads, 1.0 / 60).n_iterations);
    seconds.push_back(seconds_now() - before);
  }
  std::vector<grid::CopyId> middle;
  for (const auto c : ids<grid::CopyId>(body.complex.n_copies()))
    if (body.grid.index(body.grid.nodes(body.complex.copies[c].cell)[0])[0] ==
        body.grid.index(body.grid.nodes(grid::CellId(0u))[0])[0] + 5 * (n - 1) / 2)
      middle.push_back(c);
  std::vector<double> updates, later;
  const auto seconds_of_step = [&] {
    const double before = seconds_now();
    stepper.step(state, loads, 1.0 / 60);
    return seconds_now() - before;
  };
  for (int s = 0; s < 5; ++s) {
    const double plain = seconds_of_step(), before = seconds_now();
    model.update(body, middle);
    updates.push_back(seconds_now() - before);
    later.push_back(seconds_of_step() - plain);
  }
  std::sort(updates.begin(), updates.end());
  std::sort(later.begin(), later.end());
  const double first = seconds[0];
  std::sort(seconds.begin(), seconds.end());
  double tip = 0;
  for (std::size_t c = 0; c < rest.size(); ++c)
    tip = std::min(tip, state.x[c][2] - rest[c][2]);
  std::printf(
    "%8zu elements (%zu partial), %zu corners, nu %g: built %.4f s, first step %.4f s, median step %.5f s, lowest "
    "%.8f\n  iterations",
    model.n_elements(), model.n_partial(), rest.size(), nu, built, first, seconds[n_steps / 2], tip);
  for (const int i : iterations)
    std::printf(" %d", i);
  std::printf("\n  %zu copies changed: update %.5f s, and %.5f s more than a step before it for the next one\n",
              middle.size(), updates[2], later[2]);
}

} // namespace
} // namespace kerf::fem

int main(const int argc, char** const argv) {
  kerf::set_n_threads(argc > 4 ? std::atoi(argv[4]) : 1);
  kerf::fem::run(argc > 1 ? std::atoi(argv[1]) : 13, argc > 2 ? std::atof(argv[2]) : 0.3,
                 argc > 3 ? std::atoi(argv[3]) : 0);
}
