/// How exactly a cut surface is reproduced inside a body: the volume and area that a sphere and a cylinder cut out of a
/// cube, against h; and the parts of a box on both sides of random planes. Prints the tables of the results.

#include "base/parallel.h"
#include "tests/support/cut_by_plane.h"
#include "tests/support/rounded.h"

#include <algorithm>
#include <cstdio>
#include <numbers>

namespace {

using namespace kerf;

constexpr std::array<double, 5> spacings = {1.0 / 12, 1.0 / 20, 1.0 / 32, 1.0 / 52, 1.0 / 84};

void print_row(const support::RoundCut& round, const double h, const support::CutErrors& errors) {
  std::printf("%-10s %8.4f %12.3e %6s %12.3e %6s\n", round.name, h, errors.volume, "", errors.area, "");
}

void print_row(const support::RoundCut& round, const double h, const support::CutErrors& errors, const double h_before,
               const support::CutErrors& before) {
  const double step = std::log(h_before / h);
  std::printf("%-10s %8.4f %12.3e %6.2f %12.3e %6.2f\n", round.name, h, errors.volume,
              std::log(before.volume / errors.volume) / step, errors.area, std::log(before.area / errors.area) / step);
}

void print_rounded() {
  constexpr int n_offsets = 6;
  std::printf("relative errors, means over %d lattice offsets\n", n_offsets);
  std::printf("%-10s %8s %12s %6s %12s %6s\n", "cut out", "h [m]", "volume", "rate", "area", "rate");
  for (const support::RoundCut& round : support::round_cuts()) {
    support::CutErrors before;
    for (std::size_t i = 0; i < spacings.size(); ++i) {
      const support::CutErrors errors = support::mean_errors(round, spacings[i], n_offsets);
      if (i == 0)
        print_row(round, spacings[i], errors);
      else
        print_row(round, spacings[i], errors, spacings[i - 1], before);
      before = errors;
    }
  }
}

struct PlaneErrors {
  int n = 0, n_exact = 0;
  double worst_exact = 0, worst_other = 0; ///< relative to the box; in cells
  double mean = 0;                         ///< of all, relative to the box
  double worst_height = 0;                 ///< of a cut's vertex in a cell inside the body, off the plane [h]
};

void study(PlaneErrors& errors, const support::Body& body, const Box& box, const support::Plane& plane) {
  const double h = body.grid.h(), whole = (box.upper - box.lower).prod();
  const double error = std::abs(support::volume_below(body, plane) - support::volume_below(box, plane));
  errors.mean = (errors.mean * errors.n + error / whole) / (errors.n + 1);
  ++errors.n;
  if (error < 1e-12 * whole) {
    ++errors.n_exact;
    errors.worst_exact = std::max(errors.worst_exact, error / whole);
  } else
    errors.worst_other = std::max(errors.worst_other, error / (h * h * h));
  for (const auto c : ids<grid::CellId>(body.grid.n_cells()))
    if (!support::is_skin_cell(body.grid, c) && body.cuts.point(c))
      errors.worst_height = std::max(errors.worst_height, std::abs(plane.height(*body.cuts.point(c))) / h);
}

/// How far a plane leans, at most, from the normals of those sides of a box that it meets [degrees]: 0 where it meets
/// them at right angles.
double lean(const Box& box, const support::Plane& plane) {
  double most = 0;
  for (int side = 0; side < 6; ++side) {
    const int axis = side / 2;
    double lowest = 1, highest = -1;
    for (int corner = 0; corner < 4; ++corner) {
      Vec3 p = side & 1 ? box.upper : box.lower;
      for (const int k : {1, 2})
        p[(axis + k) % 3] = corner & k ? box.upper[(axis + k) % 3] : box.lower[(axis + k) % 3];
      lowest = std::min(lowest, plane.height(p));
      highest = std::max(highest, plane.height(p));
    }
    if (lowest < 0 && highest > 0)
      most = std::max(most, std::asin(std::min(1.0, std::abs(plane.normal[axis]))) * 180 / std::numbers::pi);
  }
  return most;
}

void print_planes() {
  const Box box{{0, 0, 0}, {0.73, 0.61, 0.52}};
  constexpr int n = 500;
  constexpr std::array<double, 4> leans = {0, 45, 60, 90};
  std::printf("\n%d random planes through a box: volume of the part below, by their lean from the sides' normals\n", n);
  std::printf("%8s %10s %7s %7s %14s %12s %18s %14s\n", "h [m]", "lean [deg]", "planes", "exact", "worst of these",
              "mean error", "worst other [h^3]", "off plane [h]");
  for (const double h : {0.1, 0.05, 0.025}) {
    support::Random random(82);
    std::array<PlaneErrors, leans.size() - 1> errors;
    for (int i = 0; i < n; ++i) {
      support::Body body =
        support::embedded(geometry::box_mesh(box.lower, box.upper), h, support::random_offset(random));
      const Vec3 normal = support::random_direction(random);
      const Vec3 through = 0.5 * (box.lower + box.upper) + 0.05 * support::random_vector(random);
      const support::Plane plane{normal, normal.dot(through)};
      support::cut_through(body, support::cuts_of_plane(body, plane));
      const auto next = std::upper_bound(leans.begin() + 1, leans.end() - 1, lean(box, plane));
      study(errors[next - leans.begin() - 1], body, box, plane);
    }
    for (std::size_t k = 0; k < errors.size(); ++k)
      std::printf("%8.4f %5.0f-%-4.0f %7d %7d %14.2e %12.3e %18.3f %14.2e\n", h, leans[k], leans[k + 1], errors[k].n,
                  errors[k].n_exact, errors[k].worst_exact, errors[k].mean, errors[k].worst_other,
                  errors[k].worst_height);
  }
}

} // namespace

int main() {
  set_n_threads(1);
  print_rounded();
  print_planes();
}
