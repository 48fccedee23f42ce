/// What a cut costs by the size of the body, at equal cut area: a blade 16 cubes wide goes 16 cubes deep into boxes of
/// ever more cells, in steps of 0.9 cubes, as scene/body.cc takes it in, stage by stage; at rest and while the body
/// drifts and turns with the blade. Cutting has a stage of its own that goes with all corners and not with what is cut,
/// fitting boxes to them: it is timed on boxes beside the cutter's, and taken off. And what all tables take of memory
/// by the cell. Prints microseconds a touched cell (a cell around an edge that is cut in the step): CPU time of one
/// thread, stage by stage the best of several runs.

#include "base/parallel.h"
#include "cut/cutter.h"
#include "surface/placement.h"
#include "surface/surface.h"
#include "tests/support/bodies.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <limits>
#include <numbers>
#include <vector>

namespace {

using namespace kerf;

enum Stage { fit, cut_, place, surface_, n_stages };
using Seconds = std::array<double, n_stages>;

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

template <class Function>
auto timed(double& seconds, const Function& f) {
  struct Stopwatch {
    double& sum;
    double start = cpu_seconds();
    ~Stopwatch() { sum += cpu_seconds() - start; }
  } const stopwatch{seconds};
  return f();
}

enum class Motion { none, drift };

/// A body as scene/body.cc keeps it, without physics.
struct Body {
  grid::Solid solid;
  surface::SurfaceIndex index = {};
  surface::Surface surface = surface::build_surface(solid, index);
  Points x = grid::rest_positions(solid), v = x;
  cut::Cutter cutter{1};

  std::size_t n_bytes() const {
    return solid.grid.n_bytes() + solid.cuts.n_bytes() + solid.complex.n_bytes() + surface.n_bytes() + index.n_bytes() +
           cutter.n_bytes() + sizeof(Vec3) * (x.capacity() + v.capacity());
  }
};

/// A box of n cells along each axis, those at the skin among them; cubes of 1 m.
Body make_body(const int n) {
  std::vector<Index3> nodes;
  for (int k = 1; k < n; ++k)
    for (int j = 1; j < n; ++j)
      for (int i = 1; i < n; ++i)
        nodes.push_back({i, j, k});
  grid::Grid grid({}, nodes);
  grid::Cuts cuts(grid);
  for (const auto e : ids<grid::EdgeId>(grid.n_edges()))
    if (const auto& [lower, upper] = grid.ends(e); grid.is_material(lower) != grid.is_material(upper))
      cuts.add(grid, {e, 0.5, Vec3::Unit(grid.axis(e)), grid::skin_label});
  grid::Solid solid{std::move(grid), std::move(cuts)};
  surface::place(solid, {});
  Body body{support::with_copies(std::move(solid))};
  body.v.reserve(body.x.capacity());
  body.cutter.begin(body.solid, body.x);
  return body;
}

/// By how much the body, and the blade with it, has turned about an axis [rad], and moved [m], in a step.
const Vec3 axis = Vec3(1, 2, 3).normalized();
double turn_at(const Motion motion, const int step) { return motion == Motion::none ? 0 : 0.002 * step; }
Vec3 place_at(const Motion motion, const int step, const Vec3& p) {
  const Vec3 shift = motion == Motion::none ? Vec3::Zero() : Vec3(0.05 * step * Vec3(1, 2, 1));
  return Eigen::AngleAxisd(turn_at(motion, step), axis) * p + shift;
}

constexpr int n_steps = 18;
constexpr double depth_per_step = 0.9, width = 16;

/// A line across the top of the box that comes down, slightly slanted; a step a second.
cut::Blade make_blade(const int n, const Motion motion) {
  cut::Blade blade{.name = "", .edge = {Vec3::Zero(), Vec3(0.06, width, 0.3)}, .key_frames = {}};
  const double middle = 0.5 * n;
  for (int step = 0; step <= n_steps; ++step) {
    const Vec3 end(middle + 0.31, middle - width / 2, n - 0.2 - depth_per_step * step);
    blade.key_frames.push_back(
      {double(step), place_at(motion, step, end), 180 / std::numbers::pi * turn_at(motion, step) * axis});
  }
  return blade;
}

struct Tally {
  Seconds seconds{};
  std::size_t n_touched = 0, n_cut = 0;
};

/// The body is built anew: a copy's tables would have no room left, and the first cut would move them.
Tally cut_through(const int n, const Motion motion) {
  Body body = make_body(n);
  const cut::Blade blade = make_blade(n, motion);
  grid::Solid& solid = body.solid;
  cut::EdgeBoxes boxes(solid);
  Tally tally;
  Seconds& s = tally.seconds;
  for (int step = 1; step <= n_steps; ++step) {
    if (motion == Motion::drift)
      for (std::size_t i = 0; i < body.x.size(); ++i)
        body.x[i] = place_at(motion, step, solid.grid.position(solid.complex.node[grid::CornerId(i)]));
    double fitting = 0;
    timed(fitting, [&] {
      if (step == 1)
        boxes.fit(body.cutter.stands_at(), body.x);
      else
        boxes.move_on(body.cutter.stands_at(), body.x);
    });
    auto change =
      timed(s[cut_], [&] { return body.cutter.step(solid, std::span(&blade, 1), step - 1, step, body.x); });
    s[fit] += fitting;
    s[cut_] -= fitting;
    timed(s[cut_], [&] {
      for (Points* points : {&body.x, &body.v})
        grid::inherit(change, *points);
    });
    timed(s[place], [&] { surface::place(solid, change, {}); });
    timed(s[surface_], [&] { surface::update_surface(solid, change, body.surface, body.index); });
    tally.n_touched += change.cells.size();
    tally.n_cut += change.edges.size();
  }
  return tally;
}

/// Stage by stage the best of some runs.
Tally best(const int n, const Motion motion, const int n_runs) {
  Tally result;
  result.seconds.fill(std::numeric_limits<double>::infinity());
  for (int run = 0; run < n_runs; ++run) {
    const Tally tally = cut_through(n, motion);
    for (int stage = 0; stage < n_stages; ++stage)
      result.seconds[stage] = std::min(result.seconds[stage], tally.seconds[stage]);
    result.n_touched = tally.n_touched;
    result.n_cut = tally.n_cut;
  }
  return result;
}

void print(const Body& body, const Tally& tally, const char* const motion) {
  const auto us = [&](const double seconds) { return 1e6 * seconds / static_cast<double>(tally.n_touched); };
  const Seconds& s = tally.seconds;
  double total = 0;
  for (int stage = cut_; stage < n_stages; ++stage)
    total += s[stage];
  std::printf("%8zu %6s %8zu %7zu %7.2f %7.2f %7.2f %7.2f %9.2e %11.3e %9.1f\n", body.solid.grid.n_cells(), motion,
              tally.n_touched, tally.n_cut, us(s[cut_]), us(s[place]), us(s[surface_]), us(total), total,
              static_cast<double>(tally.n_touched) / total,
              1e9 * s[fit] / n_steps / static_cast<double>(body.solid.complex.n_corners()));
}

struct Memory {
  double uncut = 0, cut = 0, bytes = 0;
};

/// bytes = a uncut + b cut, in the least-squares sense, relative errors.
std::array<double, 2> bytes_a_cell(const std::vector<Memory>& sizes) {
  Eigen::Matrix2d matrix = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  for (const auto& [uncut, cut, bytes] : sizes) {
    const Eigen::Vector2d row = Eigen::Vector2d(uncut, cut) / bytes;
    matrix += row * row.transpose();
    right += row;
  }
  const Eigen::Vector2d fitted = matrix.inverse() * right;
  return {fitted[0], fitted[1]};
}

} // namespace

int main(const int argc, char** const argv) {
  const int n_runs = argc > 1 ? std::max(1, std::atoi(argv[1])) : 7;
  const int largest = argc > 2 ? std::atoi(argv[2]) : 100;
  set_n_threads(1);
  std::printf(
    "%d runs (first argument), up to %d cells along an axis (second one); microseconds of one thread a touched cell\n",
    n_runs, largest);
  std::printf("%8s %6s %8s %7s %7s %7s %7s %7s %9s %11s %9s\n", "cells", "body", "touched", "edges", "cut", "place",
              "surface", "total", "total s", "cells/s", "fit ns/co");
  std::vector<Memory> sizes;
  for (const int n : {17, 28, 46, 64, 80, 100}) {
    if (n > largest)
      break;
    const Body body = make_body(n);
    print(body, best(n, Motion::none, n_runs), "rests");
    print(body, best(n, Motion::drift, n_runs), "moves");
    const double cells = static_cast<double>(body.solid.grid.n_cells());
    double cut = 0;
    for (const auto c : ids<grid::CellId>(body.solid.grid.n_cells()))
      cut += body.solid.cuts.configuration(body.solid.grid, c) != 0;
    sizes.push_back({cells - cut, cut, static_cast<double>(body.n_bytes())});
    std::printf(
      "%8.0f cells, %.0f of them at the skin: %.0f B a cell; grid %.0f, cuts %.0f, complex %.0f, surface and "
      "index %.0f, cutter %.0f, x, v %.0f\n",
      cells, cut, sizes.back().bytes / cells, static_cast<double>(body.solid.grid.n_bytes()) / cells,
      static_cast<double>(body.solid.cuts.n_bytes()) / cells, static_cast<double>(body.solid.complex.n_bytes()) / cells,
      static_cast<double>(body.surface.n_bytes() + body.index.n_bytes()) / cells,
      static_cast<double>(body.cutter.n_bytes()) / cells,
      static_cast<double>(sizeof(Vec3) * (body.x.capacity() + body.v.capacity())) / cells);
  }
  const auto [uncut, cut] = bytes_a_cell(sizes);
  std::printf("memory: %.0f B an uncut cell, %.0f B one at the skin\n", uncut, cut);
}
