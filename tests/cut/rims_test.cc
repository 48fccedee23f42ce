/// Surfaces of bodies that planes have cut, above all where the cuts meet the skin: vertices of a cut lie on its plane,
/// no triangle is without area, none is long, no vertex holds two fans of triangles together; needles are counted, and
/// triangles of a cut that look the other way, as it is folded within its plane. The
/// long tests take all closed meshes of the folder that KERF_STROKE_MESHES names:
///
///   KERF_STROKE_MESHES=folder ./kerf test -L long -R 'Rims|SlowBlades'

#include "tests/cut/patient.h"
#include "tests/cut/unit_solids.h"
#include "tests/support/cut_by_plane.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <map>
#include <numbers>

namespace kerf::cut::rims_test {
namespace {

struct Tally {
  std::size_t n_triangles = 0, n_needles = 0, n_flat = 0, n_long = 0; ///< at rims
  std::size_t n_two_fans = 0;                                         ///< vertices
  std::size_t n_of_cut = 0, n_off = 0;                                ///< of the cuts' vertices: off the plane
  double off_plane = 0;                                               ///< at most [h]
  std::size_t n_of_cap = 0, n_folded = 0;                             ///< triangles of the cuts
  double area = 0, folded_area = 0;                                   ///< of them [h^2]
};

double smallest_angle(const std::array<Vec3, 3>& p) {
  double least = std::numbers::pi;
  for (int i = 0; i < 3; ++i) {
    const Vec3 u = p[(i + 1) % 3] - p[i], v = p[(i + 2) % 3] - p[i];
    least = std::min(least, std::atan2(u.cross(v).norm(), u.dot(v)));
  }
  return least;
}

/// Vertices whose triangles do not all follow each other, side by side.
std::size_t n_with_two_fans(const surface::Surface& surface) {
  std::vector<std::map<std::uint32_t, std::uint32_t>> next(surface.rest.size()); // around each vertex
  for (const auto& triangle : surface.triangles)
    for (int i = 0; i < 3; ++i)
      next[triangle[i]][triangle[(i + 1) % 3]] = triangle[(i + 2) % 3];
  return static_cast<std::size_t>(std::ranges::count_if(next, [](const auto& around) {
    std::size_t n = 0;
    if (!around.empty())
      for (std::uint32_t v = around.begin()->first; n == 0 || v != around.begin()->first; ++n)
        v = around.at(v);
    return n != around.size();
  }));
}

void add(Tally& tally, const surface::Surface& surface, const support::Plane& plane, const double h) {
  std::vector<std::uint8_t> is_of_skin(surface.rest.size(), 0), is_of_cut = is_of_skin;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t)
    for (const auto v : surface.triangles[t])
      (surface.labels[t] == grid::skin_label ? is_of_skin : is_of_cut)[v] = 1;
  for (std::size_t v = 0; v < surface.rest.size(); ++v)
    if (is_of_cut[v]) {
      const double off = std::abs(plane.height(surface.rest[v])) / h;
      ++tally.n_of_cut;
      tally.n_off += off > 1e-6;
      tally.off_plane = std::max(tally.off_plane, off);
    }
  for (const auto& triangle : surface.triangles) {
    if (std::ranges::none_of(triangle, [&](const auto v) { return is_of_skin[v] && is_of_cut[v]; }))
      continue;
    const std::array<Vec3, 3> p = {surface.rest[triangle[0]], surface.rest[triangle[1]], surface.rest[triangle[2]]};
    const double angle = smallest_angle(p);
    ++tally.n_triangles;
    tally.n_needles += angle < std::numbers::pi / 180;
    tally.n_flat += (p[1] - p[0]).cross(p[2] - p[0]).norm() == 0;
    tally.n_long += std::max({(p[1] - p[0]).norm(), (p[2] - p[1]).norm(), (p[0] - p[2]).norm()}) > 2 * h;
  }
  tally.n_two_fans += n_with_two_fans(surface);
}

/// Of the cut's triangles, those that do not look away from their copy's material.
void add_folded(Tally& tally, const support::Body& body, const surface::Surface& surface, const support::Plane& plane) {
  const double unit = body.grid.h() * body.grid.h();
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    if (surface.labels[t] == grid::skin_label)
      continue;
    const auto& [a, b, c] = surface.triangles[t];
    const Vec3 u = surface.rest[b] - surface.rest[a], v = surface.rest[c] - surface.rest[a];
    const double up = 0.5 / unit * plane.normal.dot(u.cross(v)),
                 side = plane.height(support::point_in(body, body.complex.copies[surface.copies[t]])) < 0 ? 1 : -1;
    ++tally.n_of_cap;
    tally.area += std::abs(up);
    if (side * up < -1e-9) {
      ++tally.n_folded;
      tally.folded_area += std::abs(up);
    }
  }
}

class Rims : public testing::TestWithParam<int> {};

TEST_P(Rims, OfUnseenBodies) {
  Tally all;
  int n_bodies = 0;
  for (const auto& [name, mesh] : unit_solids(folder_of_meshes()))
    for (int i = 0; i < GetParam(); ++i, ++n_bodies) {
      support::Random random(static_cast<unsigned>(i));
      const double h = 1 / support::uniform(random, 8, 16);
      support::Body body = support::embedded(mesh, h, support::random_offset(random));
      const Vec3 normal = support::random_direction(random);
      const support::Plane plane{normal, normal.dot(mesh.vertices[random() % mesh.vertices.size()] * 0.6 +
                                                    mesh.vertices[random() % mesh.vertices.size()] * 0.4)};
      support::cut_through(body, support::cuts_of_plane(body, plane));
      const std::size_t before = all.n_two_fans, n_flat = all.n_flat, n_long = all.n_long;
      const double off_plane = all.off_plane;
      const support::Body whole = support::with_copies(std::move(body));
      const surface::Surface surface = surface::build_surface(whole);
      add(all, surface, plane, h);
      add_folded(all, whole, surface, plane);
      if (all.n_two_fans > before || all.n_flat > n_flat || all.n_long > n_long ||
          all.off_plane > std::max(off_plane, 1e-9))
        std::cout << name << ", " << i << ": " << all.n_two_fans - before << " vertices with two fans, "
                  << all.n_flat - n_flat << " triangles without area, " << all.n_long - n_long
                  << " long ones; vertices off the plane by " << all.off_plane << " h" << std::endl;
    }
  std::cout << n_bodies << " bodies; " << all.n_triangles << " triangles at rims, " << all.n_needles
            << " needles; " << all.n_off << " of " << all.n_of_cut << " vertices off their plane, by up to "
            << all.off_plane << " h; " << all.n_folded << " of " << all.n_of_cap << " triangles of cuts folded, "
            << 100 * all.folded_area / all.area << " % of their area\n";
  EXPECT_GT(all.n_triangles, 100u * n_bodies);
  EXPECT_LT(all.n_needles, 0.06 * all.n_triangles);
  EXPECT_EQ(all.n_flat, 0u);
  EXPECT_EQ(all.n_long, 0u);
  EXPECT_EQ(all.n_two_fans, 0u);
  EXPECT_LT(all.n_folded, 0.005 * all.n_of_cap); // borders that are seen from no point
  EXPECT_LT(all.folded_area, 0.001 * all.area);
  EXPECT_LE(all.n_off, all.n_of_cut / 10000); // where a cut would fold over a jagged skin, a cell's vertex gives way
}
INSTANTIATE_TEST_SUITE_P(Short, Rims, testing::Values(3));
INSTANTIATE_TEST_SUITE_P(Long, Rims, testing::Values(5));

/// Above 1e-3 cubes: less may stay where it hangs (cut/shreds.h).
std::ptrdiff_t n_pieces(const Patient& patient, const double h) {
  return std::ranges::count_if(patient.volumes(), [&](const double volume) { return volume > 1e-3 * h * h * h; });
}

/// At any speed of the blade: whatever it has met at some moment, when it has passed its cut is the plane's.
class SlowBlades : public testing::TestWithParam<int> {};

TEST_P(SlowBlades, LeaveTheCutsOfTheirPlanes) {
  Tally all;
  int n_bodies = 0;
  for (const auto& [name, mesh] : unit_solids(folder_of_meshes()))
    for (int i = 0; i < GetParam(); ++i, ++n_bodies) {
      Random random(static_cast<unsigned>(500 + i));
      const double h = 1 / uniform(random, 8, 16);
      const Vec3 normal = random_direction(random);
      const support::Plane plane{normal, normal.dot(mesh.vertices[random() % mesh.vertices.size()] * 0.6 +
                                                    mesh.vertices[random() % mesh.vertices.size()] * 0.4)};
      const Vec3 middle = Vec3::Constant(0.5);
      const Frame frame = across(normal, uniform(random, 0, 6.3));
      const Blade blade = straight(middle - plane.height(middle) * normal, frame.u, frame.v, 1.2, 1.2);
      const Patient whole(support::embedded(mesh, h, random_offset(random)));
      const auto passed = [&](const double speed) {
        Patient patient = whole;
        Cutter cutter(1, Release::queued, Fronts::of_elements);
        cutter.begin(patient.body, patient.x);
        const int n = std::max(1, static_cast<int>(2.4 / (speed * h)));
        for (int k = 0; k <= n + 1 || cutter.n_waiting() > 0; ++k)
          patient.follow(
            cutter.step(patient.body, std::span(&blade, 1), double(k) / n, double(k + 1) / n, patient.x));
        return patient;
      };
      const Patient slow = passed(uniform(random, 0.04, 0.3)), fast = passed(10);
      const std::size_t n_off = all.n_off;
      add(all, surface::build_surface(slow.body), plane, h);
      EXPECT_EQ(n_pieces(slow, h), n_pieces(fast, h)) << name << ", " << i;
      if (all.n_off > n_off)
        std::cout << name << ", " << i << ": " << all.n_off - n_off << " vertices off the plane" << std::endl;
    }
  std::cout << n_bodies << " bodies; " << all.n_off << " of " << all.n_of_cut << " vertices off their plane, by up to "
            << all.off_plane << " h\n";
  EXPECT_GT(all.n_of_cut, 100u * n_bodies);
  EXPECT_LE(all.n_off, all.n_of_cut / 10000);
}
INSTANTIATE_TEST_SUITE_P(Short, SlowBlades, testing::Values(12));
INSTANTIATE_TEST_SUITE_P(Long, SlowBlades, testing::Values(3));

} // namespace
} // namespace kerf::cut::rims_test
