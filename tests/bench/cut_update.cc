/// What a cut costs by the size of the body, at equal cut area: a blade 16 cubes wide goes 16 cubes deep into boxes of
/// ever more cells, in steps of 0.9 cubes, as scene/body.cc takes it in, stage by stage; at rest and while the body
/// drifts and turns with the blade. And what all tables take of memory by the cell. Prints microseconds a touched cell
/// (a cell around an edge that is cut in the step): CPU time of one thread, stage by stage the best of several runs.

#include "base/parallel.h"
#include "cut/add_cuts.h"
#include "cut/embed.h"
#include "cut/open_ends.h"
#include "cut/passed.h"
#include "cut/pending.h"
#include "cut/recut.h"
#include "grid/touched.h"
#include "surface/placement.h"
#include "surface/surface.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <limits>
#include <vector>

namespace {

using namespace kerf;

enum Stage { fit, find, add, place, split, surface_, passed_, n_stages };
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
  grid::Grid grid;
  grid::Cuts cuts;
  grid::CellComplex complex = grid::build_complex(grid, cuts);
  surface::SurfaceIndex index = {};
  surface::Surface surface = surface::build_surface(grid, cuts, complex, index);
  Points x = grid::rest_positions(grid, complex), v = x, x_before = x;
  cut::EdgeBoxes boxes{grid, complex};
  cut::PendingCuts pending = {};
  cut::PassedCells passed = {};
  cut::OpenEnds open_ends = {};

  std::size_t n_bytes() const {
    return grid.n_bytes() + cuts.n_bytes() + complex.n_bytes() + surface.n_bytes() + index.n_bytes() + boxes.n_bytes() +
           sizeof(Vec3) * (x.capacity() + v.capacity() + x_before.capacity());
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
  surface::place(grid, cuts, {});
  Body body{std::move(grid), std::move(cuts)};
  for (Points* points : {&body.v, &body.x_before})
    points->reserve(body.x.capacity());
  return body;
}

/// Where the body, and the blade with it, is in a step.
struct Pose {
  Mat3 turn = Mat3::Identity();
  Vec3 shift = Vec3::Zero();

  Vec3 operator()(const Vec3& p) const { return turn * p + shift; }
};

Pose pose_at(const Motion motion, const int step) {
  if (motion == Motion::none)
    return {};
  return {Eigen::AngleAxisd(0.002 * step, Vec3(1, 2, 3).normalized()).toRotationMatrix(), 0.05 * step * Vec3(1, 2, 1)};
}

constexpr int n_steps = 18;
constexpr double depth_per_step = 0.9, width = 16;

/// The blade's place at the end of a step, a line across the top of the box that comes down slightly slanted.
Points blade_at(const int n, const Motion motion, const int step) {
  const double top = n - 0.2 - depth_per_step * step, middle = 0.5 * n;
  const Pose pose = pose_at(motion, step);
  return {pose({middle + 0.31, middle - width / 2, top}), pose({middle + 0.37, middle + width / 2, top + 0.3})};
}

struct Tally {
  Seconds seconds{};
  std::size_t n_touched = 0, n_cut = 0;
};

void take_in(Body& body, const std::vector<grid::EdgeCut>& released, const std::vector<grid::EdgeId>& ended,
             Tally& tally) {
  Seconds& s = tally.seconds;
  std::vector<grid::EdgeId> edges;
  timed(s[add], [&] {
    edges = cut::add_cuts(body.grid, body.cuts, body.complex, body.x, released, cut::Front::possible).edges;
    edges.insert(edges.end(), ended.begin(), ended.end());
  });
  timed(s[passed_], [&] {
    for (const grid::EdgeId e : edges)
      body.passed.remove_around(body.grid, e);
  });
  timed(s[place], [&] { surface::place(body.grid, body.cuts, {}); });
  const auto change = timed(s[split], [&] {
    auto result = grid::update_complex(body.grid, body.cuts, edges, body.complex);
    for (Points* points : {&body.x, &body.v, &body.x_before})
      grid::inherit(result, *points);
    return result;
  });
  timed(s[surface_],
        [&] { surface::update_surface(body.grid, body.cuts, body.complex, edges, change, body.surface, body.index); });
  timed(s[add], [&] { body.open_ends.note(body.grid, body.cuts, edges, 1); });
  tally.n_touched += grid::touched_cells(body.grid, edges).size();
  tally.n_cut += edges.size();
}

/// The body is built anew: a copy's tables would have no room left, and the first cut would move them.
Tally cut_through(const int n, const Motion motion) {
  Body body = make_body(n);
  Tally tally;
  Seconds& s = tally.seconds;
  body.boxes.fit(body.x);
  for (int step = 1; step <= n_steps; ++step) {
    if (motion == Motion::drift) {
      const Pose pose = pose_at(motion, step);
      for (std::size_t i = 0; i < body.x.size(); ++i)
        body.x[i] = pose(body.grid.position(body.complex.node[grid::CornerId(i)]));
      timed(s[fit], [&] { body.boxes.fit(body.x_before, body.x); });
    }
    const cut::BladePath path{{0, 1}, {blade_at(n, motion, step - 1), blade_at(n, motion, step)}};
    const auto found = timed(s[find], [&] {
      return cut::cut_edges(path, body.grid, body.cuts, body.complex, body.x_before, body.x, 1, &body.boxes);
    });
    std::vector<grid::EdgeId> ended;
    timed(s[passed_], [&] {
      std::vector<std::array<Vec3, 3>> strip;
      cut::add_strip(path.lines[0], path.lines[1], strip);
      body.passed.pass(strip, found.cuts, body.grid, body.cuts, body.complex, body.x, body.boxes, 1);
      ended = body.open_ends.close(strip, body.pending, body.grid, body.cuts, body.complex, body.x, 1);
    });
    const auto released = timed(s[add], [&] {
      body.pending.push(found.cuts);
      return body.pending.release(body.grid, body.cuts);
    });
    take_in(body, released, ended, tally);
    if (motion == Motion::drift)
      body.x_before = body.x;
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
  for (int stage = find; stage < n_stages; ++stage)
    total += s[stage];
  std::printf("%8zu %6s %8zu %7zu %7.2f %7.2f %7.2f %7.2f %7.2f %7.2f %7.2f %9.2e %11.3e %9.1f\n", body.grid.n_cells(),
              motion, tally.n_touched, tally.n_cut, us(s[find]), us(s[add]), us(s[place]), us(s[split]),
              us(s[surface_]), us(s[passed_]), us(total), total, static_cast<double>(tally.n_touched) / total,
              1e9 * s[fit] / n_steps / static_cast<double>(body.complex.n_corners()));
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
  set_n_threads(1);
  std::printf("%d runs (first argument); microseconds of one thread a touched cell\n", n_runs);
  std::printf("%8s %6s %8s %7s %7s %7s %7s %7s %7s %7s %7s %9s %11s %9s\n", "cells", "body", "touched", "cut", "find",
              "add", "place", "complex", "surface", "passed", "total", "total s", "cells/s", "fit ns/co");
  std::vector<Memory> sizes;
  for (const int n : {17, 28, 46, 64, 80, 100}) {
    const Body body = make_body(n);
    print(body, best(n, Motion::none, n_runs), "rests");
    print(body, best(n, Motion::drift, n_runs), "moves");
    const double cells = static_cast<double>(body.grid.n_cells());
    double cut = 0;
    for (const auto c : ids<grid::CellId>(body.grid.n_cells()))
      cut += body.cuts.configuration(body.grid, c) != 0;
    sizes.push_back({cells - cut, cut, static_cast<double>(body.n_bytes())});
    std::printf(
      "%8.0f cells, %.0f of them at the skin: %.0f B a cell; grid %.0f, cuts %.0f, complex %.0f, surface and "
      "index %.0f, boxes %.0f, x, v, x_before %.0f\n",
      cells, cut, sizes.back().bytes / cells, static_cast<double>(body.grid.n_bytes()) / cells,
      static_cast<double>(body.cuts.n_bytes()) / cells, static_cast<double>(body.complex.n_bytes()) / cells,
      static_cast<double>(body.surface.n_bytes() + body.index.n_bytes()) / cells,
      static_cast<double>(body.boxes.n_bytes()) / cells,
      static_cast<double>(sizeof(Vec3) * (body.x.capacity() + body.v.capacity() + body.x_before.capacity())) / cells);
  }
  const auto [uncut, cut] = bytes_a_cell(sizes);
  std::printf("memory: %.0f B an uncut cell, %.0f B one at the skin\n", uncut, cut);
}
