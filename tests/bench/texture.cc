/// Colours of the inside, points a second on one core: painted planes of a ball by 1 to 9 exemplars of 400 x 400
/// pixels, without and with small features; and seconds to prepare each. Processor time, the best of several runs.
///
///     bench_texture [FIRST [LAST]]

#include "base/parallel.h"
#include "tests/texture/solids.h"

#include <cstdio>
#include <ctime>

namespace {

using namespace kerf;
using namespace kerf::texture;

double processor_seconds() {
  timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

template <class Function>
double best_of(const int n_runs, const Function& f) {
  double best = 1e300;
  for (int i = 0; i < n_runs; ++i) {
    const double start = processor_seconds();
    f();
    best = std::min(best, processor_seconds() - start);
  }
  return best;
}

/// A tilted plane across the ball, its pixels as large as those of the exemplars.
Patch tilted_patch() {
  const Vec3 x = Vec3(1, 0.3, 0.2).normalized(), y = Vec3(-0.3, 1, 0).normalized();
  const double pixel = 0.104 / 400;
  return {Vec3(0, 0, 0.009) - 150 * pixel * (x + y), pixel * x, pixel * y, 300, 300};
}

double mean_sources(const Interior& interior, const Patch& patch) {
  double n = 0;
  for (int r = 0; r < patch.height; ++r)
    for (int c = 0; c < patch.width; ++c)
      n += interior.blend(patch.point(c, r), {}).n;
  return n / (patch.width * patch.height);
}

void measure(const int n_exemplars) {
  const auto exemplars = axis_exemplars(citrus, n_exemplars, 400);
  const auto body = ball(5);
  std::optional<Interior> interior;
  const double preparing = best_of(1, [&] { interior.emplace(exemplars, body, InteriorOptions()); });
  std::optional<Detail> detail;
  const double histograms = best_of(1, [&] { detail.emplace(*interior); });
  const Patch patch = tilted_patch();
  const double n = static_cast<double>(patch.width) * patch.height;
  const double plain = best_of(7, [&] { paint(*interior, patch); });
  const double detailed = best_of(7, [&] { paint(*interior, patch, &*detail); });
  Blending exact;
  exact.morph = Morph::exact_inverse;
  const double inverse = best_of(2, [&] { paint(*interior, patch, nullptr, exact); });
  std::printf("%9d %8zu %8zu %9.2f %12.3g %12.3g %12.3g %11.2f %11.2f %9.1e\n", n_exemplars,
              interior->partition().cells().size(), interior->n_pairs(), mean_sources(*interior, patch), n / plain,
              n / detailed, n / inverse, preparing, histograms,
              interior->n_pairs() > 0 ? interior->smallest_determinant() : 1.0);
}

} // namespace

int main(const int argc, char** const argv) {
  set_n_threads(1);
  std::printf("%9s %8s %8s %9s %12s %12s %12s %11s %11s %9s\n", "exemplars", "cells", "warps", "sources", "points/s",
              "with small", "exact inv.", "prepare [s]", "histogr [s]", "least det");
  const int first = argc > 1 ? std::atoi(argv[1]) : 1, last = argc > 2 ? std::atoi(argv[2]) : 9;
  for (int n = first; n <= last; ++n)
    measure(n);
  return 0;
}
