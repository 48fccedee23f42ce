/// How long the first tessellation of a body takes (thesis §2.8: 1,177 cells in 282 ms), stage by stage, over six
/// grids of the liver; and how fast its surface follows the corners. Prints n, milliseconds, n/s: the median of several
/// runs, with one thread by its CPU time. Grid, the tables of the cubes alone, is a part of embed.

#include "base/parallel.h"
#include "cut/embed.h"
#include "cut/fit.h"
#include "geometry/solid.h"
#include "surface/placement.h"
#include "surface/surface.h"
#include "tests/support/checkout.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <vector>

namespace {

using namespace kerf;

double now() {
  timespec time{};
  clock_gettime(n_threads() == 1 ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Median seconds of a call; prepare() before each is not counted.
template <class Prepare, class Function>
double seconds(const Prepare& prepare, const Function& f) {
  constexpr int n_runs = 15;
  std::vector<double> taken;
  for (int i = 0; i < n_runs; ++i) {
    prepare();
    const double start = now();
    f();
    taken.push_back(now() - start);
  }
  std::nth_element(taken.begin(), taken.begin() + n_runs / 2, taken.end());
  return taken[n_runs / 2];
}

template <class Function>
double seconds(const Function& f) {
  return seconds([] {}, f);
}

std::vector<grid::NodeRun> material_runs(const grid::Grid& grid) {
  std::vector<grid::NodeRun> runs;
  for (const auto n : ids<grid::NodeId>(grid.n_nodes()))
    if (const auto [x, y, z] = grid.index(n); grid.is_material(n)) {
      if (!runs.empty() && runs.back().last + 1 == x && runs.back().y == y && runs.back().z == z)
        runs.back().last = x;
      else
        runs.push_back({x, x, y, z});
    }
  return runs;
}

std::size_t n_surface_cells(const grid::Solid& body) {
  std::size_t n = 0;
  for (const auto c : ids<grid::CellId>(body.grid.n_cells()))
    n += body.cuts.configuration(body.grid, c) != 0;
  return n;
}

void measure(const geometry::TriangleMesh& mesh, const double h) {
  const Vec3 offset = Vec3::Constant(0.5);
  const double embedding = seconds([&] { cut::embed(mesh, h, offset); });
  const grid::Solid bare = cut::embed(mesh, h, offset).solid;
  const auto runs = material_runs(bare.grid);
  const double gridding = seconds([&] { grid::Grid::from_runs(bare.grid.lattice(), runs); });
  grid::Solid solid = bare;
  const double placing = seconds([&] { solid.cuts = bare.cuts; }, [&] { surface::place(solid, {}); });
  const grid::Cuts placed = solid.cuts;
  const double fitting = seconds([&] { solid.cuts = placed; }, [&] { cut::fit_skin(mesh, solid); });
  const double copying = seconds([&] { solid.complex = grid::build_complex(solid); });
  surface::Surface surface;
  const double tessellating = seconds([&] { surface = surface::build_surface(solid); });
  const Points corners = grid::rest_positions(solid);
  Points positions;
  const double following = seconds([&] { surface::follow(surface, corners, positions); });

  const std::size_t n = n_surface_cells(bare);
  const double total = embedding + placing + fitting + copying + tessellating;
  std::printf("%7.2f %9zu %9zu %8.2f %8.2f %8.2f %8.2f %8.2f %8.2f %8.2f %12.3g %10.3g\n", 1e3 * h, bare.grid.n_cells(),
              n, 1e3 * gridding, 1e3 * embedding, 1e3 * placing, 1e3 * fitting, 1e3 * copying, 1e3 * tessellating,
              1e3 * total, static_cast<double>(n) / total, static_cast<double>(positions.size()) / following);
}

} // namespace

int main(const int argc, char** const argv) {
  if (argc > 1)
    set_n_threads(std::max(1, std::atoi(argv[1])));
  const std::string path = support::checkout() + "/params/meshes/liver_25k.off";
  const geometry::TriangleMesh mesh = geometry::require_solid(geometry::read_mesh(path, 1e-3), path);
  std::printf("threads: %d (first argument); times in ms\n", n_threads());
  std::printf("%7s %9s %9s %8s %8s %8s %8s %8s %8s %8s %12s %10s\n", "h [mm]", "cells", "surface", "grid", "embed",
              "place", "fit", "copies", "surface", "total", "surface c/s", "follow v/s");
  for (const double h : {0.0102, 0.008, 0.0057, 0.004, 0.0028, 0.002})
    measure(mesh, h);
}
