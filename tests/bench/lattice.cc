/// What a step of lattice shape matching costs: over the half width at about 10,000 corners, over the size of the body
/// at w = 2, on a block cut by a plane half through. Prints corners, milliseconds of CPU time to make the model (as
/// after a cut) and of a step, steps/s and corner steps/s; of steps the best of several runs (published: 0.54 M
/// particle steps/s, Rivers and James 2007).

#include "base/parallel.h"
#include "lattice/shape_matching.h"
#include "surface/placement.h"
#include "tests/support/placed.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>

namespace {

using namespace kerf;

/// Seconds of this process, all threads.
double cpu_time() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

support::Body cut_block(const int n) {
  support::Body body = support::with_copies(support::with_placed_skin(support::block({n, n, n}, 0.01)));
  cut::Cutter cutter(1);
  cutter.begin(body, grid::rest_positions(body));
  const double half = 0.005 * n;
  surface::place(body,
                 cutter.at_once(body, {"cut", cut::Rectangle{Vec3(half + 0.0075, half, 2 * half),
                                                             Vec3(0, 4 * half, 0), Vec3(0, 0, 2 * half)}, 1},
                                grid::rest_positions(body)),
                 {});
  return body;
}

void measure(const int n, const int half_width, const double region_damping) {
  const support::Body body = cut_block(n);
  const grid::CellComplex& complex = body.complex;
  constexpr double dt = 1.0 / 60;
  const double start_of_set_up = cpu_time();
  const lattice::Matching model(body, lattice::matching_options({.half_width = half_width}, 1000, dt));
  const double set_up = cpu_time() - start_of_set_up;
  lattice::ShapeMatching stepper(model, region_damping);
  dynamics::State state{grid::rest_positions(body), Points(complex.n_corners(), Vec3::Zero()), 0};
  support::Random random(1);
  for (Vec3& v : state.v)
    v = 0.02 * support::random_vector(random);
  const int n_steps = std::max(1, static_cast<int>(100000 / complex.n_corners())), n_runs = 9;
  double best = 1e300;
  for (int run = 0; run < n_runs; ++run) {
    const double start = cpu_time();
    for (int step = 0; step < n_steps; ++step)
      stepper.step(state, {.supports = {}}, dt);
    best = std::min(best, (cpu_time() - start) / n_steps);
  }
  std::printf("%9zu %4d %10.0f %10.2f %10.3f %10.1f %12.3g\n", complex.n_corners(), half_width, region_damping,
              1e3 * set_up, 1e3 * best, 1 / best, static_cast<double>(complex.n_corners()) / best);
}

} // namespace

int main(const int argc, char** const argv) {
  set_n_threads(argc > 1 ? std::max(1, std::atoi(argv[1])) : 1);
  std::printf("threads: %d (first argument)\n", n_threads());
  std::printf("%9s %4s %10s %10s %10s %10s %12s\n", "corners", "w", "damp [1/s]", "make [ms]", "step [ms]", "steps/s",
              "corners/s");
  for (const int half_width : {1, 2, 3, 4, 5, 6, 7, 8})
    measure(19, half_width, 0);
  measure(19, 2, 10);
  for (const int n : {8, 19, 40, 80})
    measure(n, 2, 0);
}
