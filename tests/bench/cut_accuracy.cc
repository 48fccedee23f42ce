/// How exactly a cut surface is reproduced inside a body: the volume and area that a sphere and a cylinder cut out of a
/// cube, against h; and the parts of a box on both sides of random planes. Prints the tables of the results.

#include "base/parallel.h"
#include "tests/support/clipped_box.h"
#include "tests/support/rounded.h"

#include <cstdio>

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

/// Volume on the lower side of a plane that cuts the body, from its triangles.
double volume_below(const support::Body& body, const support::Plane& plane) {
  const auto complex = grid::build_complex(body.grid, body.cuts);
  const auto surface = surface::build_surface(body.grid, body.cuts, complex);
  double volume = 0;
  for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
    const grid::Copy& copy = complex.copies[surface.copies[i]];
    const auto node = body.grid.nodes(copy.cell)[std::countr_zero(unsigned(copy.nodes))];
    const auto& [a, b, c] = surface.triangles[i];
    if (plane.height(body.grid.position(node)) < 0)
      volume += surface.rest[a].dot(surface.rest[b].cross(surface.rest[c])) / 6;
  }
  return volume;
}

struct PlaneErrors {
  int n_exact = 0;
  double worst_exact = 0, worst_other = 0; ///< relative to the box; in cells
  double worst_height = 0;                 ///< of a cut's vertex in a cell inside the body, off the plane [h]
};

void study(PlaneErrors& errors, support::Body body, const Box& box, const support::Plane& plane) {
  support::cut(body, support::plane_cuts(body, plane));
  const double h = body.grid.h(), whole = (box.upper - box.lower).prod();
  const double error = std::abs(volume_below(body, plane) - support::volume_below(box, plane));
  if (error < 1e-12 * whole) {
    ++errors.n_exact;
    errors.worst_exact = std::max(errors.worst_exact, error / whole);
  } else
    errors.worst_other = std::max(errors.worst_other, error / (h * h * h));
  for (const auto c : ids<grid::CellId>(body.grid.n_cells()))
    if (!support::is_skin_cell(body.grid, c) && body.cuts.point(c))
      errors.worst_height = std::max(errors.worst_height, std::abs(plane.height(*body.cuts.point(c))) / h);
}

void print_planes() {
  const Box box{{0, 0, 0}, {0.73, 0.61, 0.52}};
  constexpr int n = 500;
  std::printf("\n%d random planes through a box: volume of the part below\n", n);
  std::printf("%8s %8s %14s %18s %16s\n", "h [m]", "exact", "worst of these", "worst other [h^3]", "off plane [h]");
  for (const double h : {0.1, 0.05, 0.025}) {
    support::Random random(82);
    PlaneErrors errors;
    for (int i = 0; i < n; ++i) {
      const support::Body body =
        support::embedded(geometry::box_mesh(box.lower, box.upper), h, support::random_offset(random));
      const Vec3 normal = support::random_direction(random);
      const Vec3 through = 0.5 * (box.lower + box.upper) + 0.05 * support::random_vector(random);
      study(errors, body, box, {normal, normal.dot(through)});
    }
    std::printf("%8.4f %8d %14.2e %18.3f %16.2e\n", h, errors.n_exact, errors.worst_exact, errors.worst_other,
                errors.worst_height);
  }
}

} // namespace

int main() {
  set_n_threads(1);
  print_rounded();
  print_planes();
}
