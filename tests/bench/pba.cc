/// How fast point-based animation runs: forces, symplectic Euler, implicit Euler, new sights, the surface's corners.
/// A block about as deep as it is wide, filled with a jittered grid. Prints n, seconds, n/s: best of several runs, CPU
/// time of one thread.

#include "base/parallel.h"
#include "dynamics/implicit_euler.h"
#include "dynamics/symplectic_euler.h"
#include "grid/locate.h"
#include "pba/corners.h"
#include "pba/model.h"
#include "tests/support/bodies.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>

namespace {

using namespace kerf;

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Least CPU seconds of a call, out of several times `n_calls` of them.
template <class Function>
double seconds(const int n_calls, const Function& f) {
  double least = 1e300;
  for (int run = 0; run < 7; ++run) {
    const double start = cpu_seconds();
    for (int i = 0; i < n_calls; ++i)
      f();
    least = std::min(least, (cpu_seconds() - start) / n_calls);
  }
  return least;
}

void measure(const double n_wanted) {
  constexpr int cells = 17;
  constexpr double edge = 0.2;
  const support::Body body = support::with_copies(support::block({cells, cells, cells}, edge / cells));
  pba::PhyxelOptions options;
  options.sampling.spacing = edge / std::cbrt(n_wanted);
  const double filling = seconds(1, [&] { pba::fill(body, options); });
  const pba::Phyxels phyxels = pba::fill(body, options);
  pba::PhyxelModel model(phyxels, {}, {});
  const auto& pairs = model.neighbours().pairs;
  const auto clear = pba::clear_sights(phyxels.rest, phyxels.rest, pairs);
  std::vector<pba::Sight> half = clear;
  for (pba::Sight& sight : half)
    sight.factor = 0.5;

  dynamics::State state{phyxels.rest, Points(phyxels.size(), Vec3(0, 0, 0.01)), 0};
  state.x[0] += Vec3::Constant(1e-4);
  dynamics::Loads loads;
  loads.gravity = Vec3(0, 0, -9.81);
  dynamics::SymplecticEuler symplectic(model);
  dynamics::ImplicitEuler implicit(model, {});
  Points forces, corners;
  std::vector<Mat3> F;
  const int n = std::max(1, static_cast<int>(3e5 / static_cast<double>(pairs.size())));
  const double forcing = seconds(n, [&] { model.force(state.x, forces); });
  const double stepping = seconds(n, [&] { symplectic.step(state, loads, 1e-5); });
  dynamics::State start = state;
  const double solving = seconds(1, [&] { implicit.step(start = state, loads, 1.0 / 60); });
  const double updating = 0.5 * seconds(1, [&] {
                            model.update(half);
                            model.update(clear);
                          });

  const auto node_pairs = pba::find_node_pairs(body.grid, phyxels);
  const auto sights = pba::clear_sights(node_pairs.rest, phyxels.rest, node_pairs.pairs);
  const auto copies = grid::copies_around(body, phyxels.rest);
  pba::CornerMap map;
  const double mapping = seconds(1, [&] { map = pba::build_corner_map(body, phyxels, copies, node_pairs, sights); });
  const double following = seconds(n, [&] {
    model.deformation(state.x, F);
    pba::follow(map, state.x, F, corners);
  });
  std::printf("%8zu %8zu %6.1f %9.1f %9.3f %9.3f %9.0f %9.2f %9.3f %9zu %9.2f %9.3f %12.0f\n", phyxels.size(),
              pairs.size(), 2.0 * static_cast<double>(pairs.size()) / static_cast<double>(phyxels.size()),
              1e3 * filling, 1e3 * forcing, 1e3 * stepping, 1 / stepping, 1e3 * solving, 1e3 * updating, corners.size(),
              1e3 * mapping, 1e3 * following, 1 / (stepping + following));
}

} // namespace

int main() {
  set_n_threads(1);
  std::printf("one thread; CPU times in ms\n");
  std::printf("%8s %8s %6s %9s %9s %9s %9s %9s %9s %9s %9s %9s %12s\n", "phyxels", "pairs", "mean k", "fill", "force",
              "step", "steps/s", "implicit", "update", "corners", "map", "follow", "both, 1/s");
  for (const double n : {100.0, 566.0, 3000.0, 20000.0})
    measure(n);
}
