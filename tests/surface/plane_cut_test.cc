/// Bodies cut by planes, against the exact volumes on both sides.

#include "cut/pending.h"
#include "tests/support/cut_by_plane.h"

#include <gtest/gtest.h>

#include <iostream>
#include <numbers>
#include <numeric>

namespace kerf::surface::plane_cut_test {
namespace {

using grid::CopyId;
using support::Body;
using support::Plane;
using support::Random;
using support::random_offset;
using support::uniform;

const Box box{{0, 0, 0}, {0.73, 0.61, 0.52}};

/// Half in the coordinate planes, half in general directions.
Points tilts() {
  Random random(34);
  Points normals = {Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
  for (int i = 0; i < 8; ++i) {
    const double angle = (i + 0.5) / 8 * std::numbers::pi;
    Vec3 n = Vec3::Zero();
    n[i % 3] = std::cos(angle);
    n[(i + 1) % 3] = std::sin(angle);
    normals.push_back(n);
  }
  while (normals.size() < 20)
    normals.push_back(support::random_direction(random));
  return normals;
}

/// Volume of the pieces on the lower side of a plane that cut them all.
double cut_volume_below(const Body& cut, const Plane& plane) {
  const Body body = support::with_copies(cut);
  const auto& complex = body.complex;
  const grid::Pieces pieces = grid::pieces(complex);
  EXPECT_LE(pieces.n_pieces, 2u);
  const auto volumes = piece_volumes(build_surface(body), complex);
  std::vector<int> n_below(pieces.n_pieces, 0), n_copies = n_below;
  for (const auto c : ids<CopyId>(complex.n_copies())) {
    ++n_copies[pieces.piece[c]];
    n_below[pieces.piece[c]] += plane.height(support::point_in(body, complex.copies[c])) < 0;
  }
  double below = 0;
  for (std::uint32_t p = 0; p < pieces.n_pieces; ++p) {
    EXPECT_TRUE(n_below[p] == 0 || n_below[p] == n_copies[p]) << "a piece has material on both sides";
    below += n_below[p] > 0 ? volumes[p] : 0;
  }
  return below;
}

double total_volume(const Body& body) {
  const auto volumes = support::octant_volumes(support::with_copies(body));
  return std::accumulate(volumes.begin(), volumes.end(), 0.0);
}

/// Every plane, also where it cuts a tip off a sharp edge between the lattice's edges.
TEST(PlaneCut, GivesExactVolumes) {
  Random random(35);
  const Points normals = tilts();
  const double whole = (box.upper - box.lower).prod();
  std::size_t n_planes = 0;
  double worst = 0, worst_total = 0;
  for (int i = 0; i < 50; ++i) {
    const Body body = support::embedded(geometry::box_mesh(box.lower, box.upper), 0.1, random_offset(random));
    ASSERT_NEAR(support::surface_volume(body), whole, 1e-13);
    for (const Vec3& normal : normals) {
      const Vec3 through = 0.5 * (box.lower + box.upper) + 0.1 * (i - 24.5) / 50 * Vec3::Ones();
      const Plane plane{normal, normal.dot(through)};
      Body cut = body;
      support::cut_through(cut, support::cuts_of_plane(cut, plane));
      worst = std::max(worst, std::abs(cut_volume_below(cut, plane) - support::volume_below(box, plane)) / whole);
      worst_total = std::max(worst_total, std::abs(total_volume(cut) / whole - 1));
      ++n_planes;
    }
  }
  std::cout << n_planes << " planes, worst error of a piece " << worst << ", of the total " << worst_total << '\n';
  EXPECT_LT(worst, 1e-12);
  EXPECT_LT(worst_total, 1e-12);
}

/// Volume below a plane of a body as its surface bounds it [m^3].
double volume_below_in(const Surface& surface, const Plane& plane) {
  const Vec3 on_plane = plane.offset * plane.normal;
  double six_volumes = 0;
  for (const auto& t : surface.triangles) {
    std::vector<Vec3> below; // the triangle's part, from a point of the plane: what closes it has no volume
    for (int k = 0; k < 3; ++k) {
      const Vec3 p = surface.rest[t[k]] - on_plane, q = surface.rest[t[(k + 1) % 3]] - on_plane;
      const double a = plane.normal.dot(p), b = plane.normal.dot(q);
      if (a < 0)
        below.push_back(p);
      if ((a < 0) != (b < 0))
        below.push_back(p + a / (a - b) * (q - p));
    }
    for (std::size_t k = 1; k + 1 < below.size(); ++k)
      six_volumes += below[0].dot(below[k].cross(below[k + 1]));
  }
  return six_volumes / 6;
}

/// Any body: what is below the plane is what the plane leaves of the surface that the body had.
TEST(PlaneCut, OfAnyBodyGivesWhatLiesBelow) {
  Random random(38);
  const Body liver = support::embedded(support::liver_mesh(), 0.012, Vec3::Constant(0.4));
  double worst = 0;
  constexpr int n = 60;
  for (int i = 0; i < n; ++i) {
    Body body =
      i % 2 ? liver : support::embedded(geometry::sphere_mesh(0.4, Vec3::Zero(), 3), 0.1, random_offset(random));
    const Vec3 normal = support::random_direction(random);
    const Vec3 through = body.grid.position(grid::NodeId(random() % body.grid.n_nodes()));
    const Plane plane{normal, normal.dot(through) + 0.1 * body.grid.h()};
    const double exact = volume_below_in(build_surface(support::with_copies(body)), plane);
    support::cut_through(body, support::cuts_of_plane(body, plane));
    worst = std::max(worst, std::abs(support::volume_below(body, plane) - exact) / std::pow(body.grid.h(), 3));
  }
  std::cout << n << " planes, worst error of a side " << worst << " h^3\n";
  EXPECT_LT(worst, 1e-9);
}

/// In steps of two edges a cell: the skin at once, edges as they are released.
TEST(PlaneCut, IsAsExactInManySteps) {
  Random random(36);
  double worst = 0;
  for (int i = 0; i < 20; ++i) {
    Body body = support::embedded(geometry::box_mesh(box.lower, box.upper), 0.1, random_offset(random));
    const Plane plane{Vec3::Unit(i % 3), uniform(random, 0.15, 0.4)};
    auto [cuts, of_skin, n_double, later, later_of_skin] = support::cuts_of_plane(body, plane);
    std::shuffle(cuts.begin(), cuts.end(), random);
    cut::PendingCuts pending;
    pending.push(cuts);
    int n_steps = 0;
    for (; pending.size() > 0; ++n_steps) {
      support::cut_through(body, {pending.release(body), of_skin, 0});
      of_skin.clear();
    }
    EXPECT_GT(n_steps, 1);
    worst = std::max(worst, std::abs(cut_volume_below(body, plane) - support::volume_below(box, plane)));
  }
  EXPECT_LT(worst, 1e-12 * (box.upper - box.lower).prod());
}

} // namespace
} // namespace kerf::surface::plane_cut_test
