/// Visibility disks a second on one core (32 x 32 texels, seen from both points, each disk with faces of its own, each
/// update from scratch), by the processor and by OpenGL; and pairs a second through the whole criterion, search and
/// queue included. Seconds of processor time of the thread, the best of several runs.

#include "base/parallel.h"
#include "tests/visibility/cases.h"
#include "visibility/cpu_rasteriser.h"
#include "visibility/field.h"
#include "visibility/gl_rasteriser.h"
#include "visibility/pair_sights.h"

#include <algorithm>
#include <cstdio>
#include <ctime>

namespace {

using namespace kerf;
using namespace kerf::visibility;

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

/// How many of the faces are drawn, both views counted: the rest is looked past.
double drawn_views(Disks& disks) {
  std::size_t n = 0;
  for (std::size_t i = 0; i < disks.pairs.size(); ++i)
    for (const Face& face : disks.faces_of(i))
      for (const int side : {0, 1})
        n += may_occlude(make_disk(disks.pairs[i], disks.shape), disks.shape, face, side);
  return static_cast<double>(n) / static_cast<double>(disks.pairs.size());
}

void measure_disks(const int n_faces, const double spread, const double size, Rasteriser& gl) {
  constexpr int n_disks = 20000;
  Disks disks = random_disks(1, n_disks, n_faces, spread, size);
  CpuRasteriser cpu;
  const std::vector<DiskUpdate> updates = disks.updates();
  const double views = drawn_views(disks);
  const double by_cpu = best_of(15, [&] { cpu.occlude(disks.shape, disks.faces, updates); });
  const double occluded = count(disks.masks) / (double(n_disks) * disks.shape.n_texels());
  std::fill(disks.masks.begin(), disks.masks.end(), 0u);
  const double by_gl = best_of(3, [&] { gl.occlude(disks.shape, disks.faces, updates); });
  std::printf("%9d %9.1f %12.2f %10.3f %12.3g %12.3g\n", n_faces, size, views, occluded, n_disks / by_cpu,
              n_disks / by_gl);
}

/// The cube [-.5, .5]^3 m around the cloud, each side in 40 x 40 squares.
std::vector<Face> skin() {
  std::vector<Face> faces;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-0.5, 0.5})
      for (int i = 0; i < 40; ++i)
        for (const std::vector<Face>& square : growing_strip(-0.5, 0.5, 40, 0.0125, side))
          for (Face face : square) {
            for (Vec3& p : face) {
              p[1] += -0.5 + (i + 0.5) / 40;
              p = Vec3(p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]);
            }
            faces.push_back(face);
          }
  return faces;
}

/// A cut through a cloud of points, strip by strip: seconds for the search and for the updates.
void measure_criterion(const std::string& name, const std::vector<Face>& skin) {
  Random random(1);
  std::vector<Pair> pairs;
  for (int i = 0; i < 20000; ++i) {
    const Vec3 a = 0.5 * random.vector();
    const Vec3 b = a + (0.05 + 0.1 * random.number()) * random.direction();
    pairs.push_back({a, b.cwiseMax(-0.499).cwiseMin(0.499), 0.3});
  }
  double searching = 1e300, updating = 1e300;
  std::size_t n_looks = 0;
  for (int run = 0; run < 3; ++run) {
    CriterionChoice choice;
    choice.criterion = name;
    PairSights sights(make_criterion(choice, skin));
    sights.watch(PairId(0), pairs);
    n_looks = 0;
    double search = 0, update = 0;
    for (int row = 0; row < 40; ++row) {
      std::vector<Face> faces;
      for (int i = 0; i < 40; ++i)
        for (const Face& face : strip(-0.5 + row / 40., -0.5 + (row + 1) / 40., 0.0125, 0.01)) {
          Face moved = face;
          for (Vec3& corner : moved)
            corner[1] += -0.5 + (i + 0.5) / 40;
          faces.push_back(moved);
        }
      search += best_of(1, [&] { sights.add_faces(faces); });
      n_looks += sights.n_waiting();
      update += best_of(1, [&] { sights.update(pairs.size()); });
    }
    searching = std::min(searching, search);
    updating = std::min(updating, update);
  }
  std::printf("%-20s %6zu %9zu %10.2f %10.2f %12.3g\n", name.c_str(), skin.size(), n_looks, 1e3 * searching,
              1e3 * updating, static_cast<double>(n_looks) / (searching + updating));
}

} // namespace

int main() {
  set_n_threads(1);
  GlRasteriser gl;
  std::printf("%9s %9s %12s %10s %12s %12s\n", "faces", "size [1]", "views drawn", "occluded", "CPU disks/s",
              "GL disks/s");
  for (const int n_faces : {2, 8, 20})
    for (const auto& [spread, size] : {std::pair{0.4, 0.2}, {0.4, 0.6}, {0.05, 0.6}})
      measure_disks(n_faces, spread, size, gl);
  std::printf("\n20000 pairs, a cut of 3200 faces in 40 parts\n%-20s %6s %9s %10s %10s %12s\n", "criterion", "skin",
              "looks", "search ms", "update ms", "looks/s");
  for (const std::string& name : criteria())
    measure_criterion(name, {});
  measure_criterion("extended visibility", skin());
}
