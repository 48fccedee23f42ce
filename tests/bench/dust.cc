/// What a step costs of a body that is cut into some 1,000 pieces, over one of the same body whole: all that a run does
/// in a step but writing, while nothing is being cut. A box hangs from the ceiling, strained by waves of eight cubes,
/// and sways; the other one is cut before by planes. Steps of both are taken in turn. Prints the median of a step's
/// time of both [ms] and of their ratio, by the processor's clock, one thread; and what the pieces have more of:
/// copies, corners, triangles; and the mean iterations of the linear solver in a step.
///
///     bench_dust [MIX [BACKEND [STEPS [KEY=VALUE ...]]]]
///
/// MIX and BACKEND: those whose names hold these words. KEY: of the scene, as "Body b/Element=enhanced".

#include "base/parallel.h"
#include "scene/compose.h"
#include "scene/run.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <numeric>
#include <string>
#include <vector>

namespace {

using namespace kerf;
using namespace kerf::scene;

using Slabs = std::array<std::vector<int>, 3>;

constexpr double h = 0.02;

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// A box of nodes, and slabs of nodes along its axes, which cuts part up to a height.
struct Mix {
  std::string name;
  std::array<int, 3> n;
  Slabs slabs;                   ///< thickness of each, from below; of z one more, of what is left
  bool is_cut_to_the_top = true; ///< else as far as the slabs of z reach
};

std::vector<int> equal(const int n, const int thickness) { return std::vector<int>(n, thickness); }

std::vector<Mix> mixes() {
  const auto one = equal(10, 1), two = equal(10, 2), three = equal(10, 3);
  const std::vector<int> mixed = {2, 3, 2, 3, 2, 3, 2, 3, 2, 3};
  const std::vector<int> pair = {1, 1};
  return {{"1000 crumbs of 1", {10, 10, 10}, Slabs{one, one, one}},
          {"1000 crumbs of 2x2x2", {20, 20, 20}, Slabs{two, two, two}},
          {"500 crumbs, 500 of 3x2x2", {25, 20, 20}, Slabs{mixed, two, two}},
          {"1000 crumbs, one of 10x10x20", {10, 10, 30}, Slabs{one, one, one}, false},
          {"1000 crumbs, one of 20x25x20", {20, 25, 22}, Slabs{equal(20, 1), equal(25, 1), equal(2, 1)}, false},
          {"1000 of 3x3x3", {30, 30, 30}, Slabs{three, three, three}}};
}

std::string point(const double x, const double y, const double z) {
  return std::to_string(x) + ", " + std::to_string(y) + ", " + std::to_string(z);
}

std::string cuts(const Mix& mix) {
  std::string text;
  const std::array<double, 3> far = {mix.n[0] * h + 0.1, mix.n[1] * h + 0.1, mix.n[2] * h + 0.1};
  const double top = mix.is_cut_to_the_top ? far[2] : h * std::accumulate(mix.slabs[2].begin(), mix.slabs[2].end(), 0);
  for (int axis = 0; axis < 3; ++axis) {
    double at = 0;
    for (std::size_t k = 0; k < mix.slabs[axis].size(); ++k) {
      at += h * mix.slabs[axis][k];
      if (at > h * (mix.n[axis] - 0.5))
        break;
      const Vec3 middle(axis == 0 ? at : 0.5 * (far[0] - 0.1), axis == 1 ? at : 0.5 * (far[1] - 0.1),
                        axis == 2 ? at : 0.5 * top - 0.05);
      Vec3 sides[2];
      int n = 0;
      for (int other = 0; other < 3; ++other)
        if (other != axis)
          sides[n++] = Vec3::Unit(other) * (other == 2 ? top + 0.1 : far[other] + 0.1);
      text += "subsection Cut surface c" + std::to_string(axis) + "_" + std::to_string(k) +
              "\n  set Time [s] = 0.01\n  set Shape = rectangle\n  set Point [m] = " +
              point(middle[0], middle[1], middle[2]) +
              "\n  set First side [m] = " + point(sides[0][0], sides[0][1], sides[0][2]) +
              "\n  set Second side [m] = " + point(sides[1][0], sides[1][1], sides[1][2]) + "\nend\n";
    }
  }
  return text;
}

World world_of(const Mix& mix, const std::string& backend, const bool is_cut,
               const std::vector<std::string>& overrides) {
  const double x = mix.n[0] * h, y = mix.n[1] * h, z = mix.n[2] * h;
  const std::string text =
    "subsection Time\n  set Time step [s] = 0.01\n  set End time [s] = 10\nend\n"
    "subsection Gravity\n  set Acceleration [m/s^2] = 2, 0, -9.81\nend\n"
    "subsection Body b\n  set Shape = box\n  set Centre [m] = " +
    point(x / 2, y / 2, z / 2) + "\n  set Sides [m] = " + point(x, y, z) +
    "\n  set Cube edge [m] = " + std::to_string(h) + "\n  set Backend = " + backend +
    "\n  subsection Material\n    set Density [kg/m^3] = 1000\n    set Young's modulus [Pa] = 8e3\n"
    "    set Poisson's ratio [1] = 0.4\n  end\n"
    "  subsection Initial state\n    set Displacement [m] = .003*sin(40*y); .003*sin(40*z); .003*sin(40*x)\n"
    "    set Velocity [m/s] = .1*sin(40*z); .1*sin(40*x); .1*sin(40*y)\n  end\n"
    "  subsection Support ceiling\n    set Lower [m] = -1, -1, " +
    std::to_string(z - 0.6 * h) + "\n    set Upper [m] = 9, 9, 9\n  end\nend\n" + (is_cut ? cuts(mix) : "");
  return compose(scan_scene_text(text, "dust.prm", overrides));
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 0 : values[values.size() / 2];
}

/// Advances a world and returns the seconds it took.
double timed(World& world, const int step, Timings& seconds) {
  const double start = cpu_seconds();
  advance(world, step, seconds);
  return cpu_seconds() - start;
}

void compare(const Mix& mix, const std::string& backend, const int n_steps, const std::vector<std::string>& overrides) {
  constexpr int first = 4;
  World whole = world_of(mix, backend, false, overrides), cut = world_of(mix, backend, true, overrides);
  std::vector<double> of_whole, of_cut, ratios;
  double iterations[2] = {0, 0};
  Timings setup, seconds[2];
  for (int step = 1; step < first; ++step) {
    timed(whole, step, setup);
    timed(cut, step, setup);
  }
  for (int step = first; step < first + n_steps; ++step) {
    const double a = timed(whole, step, seconds[0]), b = timed(cut, step, seconds[1]);
    of_whole.push_back(1e3 * a);
    of_cut.push_back(1e3 * b);
    ratios.push_back(b / a);
    iterations[0] += whole.bodies[0].report.n_iterations;
    iterations[1] += cut.bodies[0].report.n_iterations;
  }
  const Body &a = whole.bodies[0], &b = cut.bodies[0];
  std::size_t n_free = 0;
  for (std::size_t i = 0; i < b.state.x.size(); ++i)
    n_free += !b.physics->crumbs().carries(i);
  std::printf(
    "%-30s %-12s %8.2f %8.2f %6.2f  %7zu %7zu %5.2f  %7zu %7zu %7zu  %7zu %7zu  %5.1f %5.1f  %4zu  %.2f %.2f\n",
    mix.name.c_str(), backend.c_str(), median(of_whole), median(of_cut), median(ratios), a.solid.complex.n_copies(),
    b.solid.complex.n_copies(), double(b.solid.complex.n_copies()) / double(a.solid.complex.n_copies()),
    a.state.x.size(), b.state.x.size(), n_free, a.surface.triangles.size(), b.surface.triangles.size(),
    iterations[0] / n_steps, iterations[1] / n_steps, b.physics->crumbs().size(), 1e3 * seconds[0]["surface"] / n_steps,
    1e3 * seconds[1]["surface"] / n_steps);
  std::fflush(stdout);
}

} // namespace

int main(const int argc, char** argv) {
  set_n_threads(1);
  const std::string mix_word = argc > 1 ? argv[1] : "", backend_word = argc > 2 ? argv[2] : "";
  const int n_steps = argc > 3 ? std::atoi(argv[3]) : 31;
  std::vector<std::string> settings;
  for (int i = 4; i < argc; ++i)
    settings.emplace_back(argv[i]);
  std::printf("%-30s %-12s %8s %8s %6s  %7s %7s %5s  %7s %7s %7s  %7s %7s  %5s %5s  %s\n", "mix", "backend", "whole",
              "cut", "ratio", "copies", "cut", "ratio", "points", "cut", "free", "faces", "cut", "iter", "cut",
              "crumbs");
  for (const std::string backend : {"fem", "lattice", "mass-spring", "pba"})
    for (const Mix& mix : mixes())
      if (mix.name.find(mix_word) != std::string::npos && backend.find(backend_word) != std::string::npos)
        compare(mix, backend, n_steps, settings);
  return 0;
}
