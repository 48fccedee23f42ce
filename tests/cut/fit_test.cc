/// The skin's vertices against a search through the whole mesh.

#include "cut/fit.h"

#include "base/parallel.h"
#include "geometry/triangle.h"
#include "grid/cube.h"
#include "tests/support/placed.h"

#include <gtest/gtest.h>

#include <iostream>
#include <optional>

namespace kerf::cut::fit_test {
namespace {

using grid::CellId;
using support::Body;

Body placed(const geometry::TriangleMesh& mesh, const double h, const Vec3& offset) {
  return support::with_placed_skin(embed(mesh, h, offset).solid);
}

double distance(const geometry::TriangleMesh& mesh, const Vec3& p) {
  double nearest = 1e300;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    nearest = std::min(nearest, (geometry::closest_point(p, geometry::corners(mesh, t)) - p).norm());
  return nearest;
}

/// What fit.h promises, for one vertex at p in a cell, by all triangles: nothing where it stays.
std::optional<Vec3> plainly_fitted(const geometry::TriangleMesh& mesh, const Body& body, const CellId c, const Vec3& p,
                                   const Vec3& direction, const int normal) {
  const Vec3 lower = body.grid.origin(c);
  const double h = body.grid.h(), margin = grid::min_edge_parameter * h;
  std::optional<Vec3> best;
  const auto offer = [&](const std::optional<Vec3>& q) {
    if (!q)
      return;
    for (int axis = 0; axis < 3; ++axis)
      if (axis != normal && ((*q)[axis] - lower[axis] < margin || (*q)[axis] - lower[axis] > h - margin))
        return;
    if (!best || (*q - p).squaredNorm() < (*best - p).squaredNorm())
      best = q;
  };
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (const auto s = geometry::line_meets(p, direction, geometry::corners(mesh, t)))
      offer(p + *s * direction);
  if (best)
    return best;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    offer(normal < 0 ? std::optional(geometry::closest_point(p, geometry::corners(mesh, t)))
                     : geometry::closest_point_in_plane(p, normal, geometry::corners(mesh, t)));
  return best;
}

template <class Lines>
Vec3 outward(const Body& body, const CellId c, const Lines& lines) {
  Vec3 sum = Vec3::Zero();
  for (const int line : lines)
    if (body.cuts.is_cut(body.grid.edges(c)[line]))
      sum[grid::cube::line_axis(line)] +=
        body.grid.is_material(body.grid.nodes(c)[grid::cube::line_vertices[line][0]]) ? 1 : -1;
  return sum.norm() > 0 ? Vec3(sum.normalized()) : sum;
}

/// Every `stride`-th vertex.
void expect_fitted(const geometry::TriangleMesh& mesh, const double h, const Vec3& offset, const int stride) {
  const Body before = placed(mesh, h, offset);
  Body after = before;
  fit_skin(mesh, after);
  std::size_t n_moved = 0, n_seen = 0;
  int k = 0;
  const auto expect = [&](const std::optional<Vec3>& expected, const Vec3& was, const Vec3& is) {
    ++n_seen;
    n_moved += is != was;
    ASSERT_LT((is - expected.value_or(was)).norm(), 1e-12 * h);
  };
  constexpr std::array<int, 12> all_lines = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
  for (const CellId c : ids<CellId>(after.grid.n_cells())) {
    if (after.cuts.configuration(after.grid, c) == 0)
      continue;
    for (int face = 0; face < 6; ++face) {
      const grid::FaceId f = after.grid.faces(c)[face];
      if (!((face & 1) == 1 || !after.grid.cells(f)[0].valid()) || !before.cuts.point(f) || ++k % stride != 0)
        continue;
      const Vec3 p = *before.cuts.point(f);
      const auto expected =
        distance(mesh, p) < 1e-9 * h
          ? std::nullopt
          : plainly_fitted(mesh, after, c, p, outward(after, c, grid::cube::face_lines[face]), face / 2);
      expect(expected, p, *after.cuts.point(f));
    }
    if (++k % stride != 0)
      continue;
    Vec3 mean = Vec3::Zero();
    int n = 0;
    for (const auto f : after.grid.faces(c))
      if (const Vec3* q = after.cuts.point(f)) {
        mean += *q;
        ++n;
      }
    mean /= n;
    const Vec3 p = *before.cuts.point(c);
    const bool stays = distance(mesh, p) < 1e-9 * h || distance(mesh, mean) < 1e-9 * h;
    expect(stays ? std::nullopt : plainly_fitted(mesh, after, c, mean, outward(after, c, all_lines), -1), p,
           *after.cuts.point(c));
  }
  std::cout << n_seen << " vertices compared, " << n_moved << " moved\n";
  EXPECT_GT(n_seen, 100u);
}

TEST(Fit, IsThatOfAPlainSearchOnASphere) {
  expect_fitted(geometry::sphere_mesh(1, Vec3::Zero(), 3), 0.21, {0.2, 0.4, 0.9}, 2);
  expect_fitted(geometry::sphere_mesh(1, Vec3::Zero(), 1), 0.07, {0.5, 0.5, 0.5}, 7);
}

TEST(Fit, IsThatOfAPlainSearchOnTheLiver) { expect_fitted(support::liver_mesh(), 0.016, {0.5, 0.3, 0.1}, 12); }

TEST(Fit, IsThatOfAPlainSearchOnThinWalls) {
  const auto inner = geometry::inside_out(geometry::sphere_mesh(0.93, Vec3::Zero(), 2));
  expect_fitted(geometry::together(geometry::sphere_mesh(1, Vec3::Zero(), 2), inner), 0.13, {0.3, 0.1, 0.7}, 3);
}

TEST(Fit, LeavesABoxAsItIs) {
  const auto mesh = geometry::box_mesh({0, 0, 0}, {0.73, 0.61, 0.52});
  const Body before = placed(mesh, 0.1, {0.31, 0.83, 0.12});
  Body after = before;
  fit_skin(mesh, after);
  for (const CellId c : ids<CellId>(after.grid.n_cells()))
    if (before.cuts.point(c)) {
      EXPECT_LT(distance(mesh, *after.cuts.point(c)), 1e-15);
      EXPECT_EQ(*before.cuts.point(c), *after.cuts.point(c)) << "its edges and corners are met by the planes already";
    }
}

TEST(Fit, IsTheSameWithOneAndTwoThreads) {
  const auto mesh = support::liver_mesh();
  std::array<Body, 2> bodies = {placed(mesh, 0.01, Vec3::Constant(0.5)), placed(mesh, 0.01, Vec3::Constant(0.5))};
  const int n_before = n_threads();
  for (int n = 1; n <= 2; ++n) {
    set_n_threads(n);
    fit_skin(mesh, bodies[n - 1]);
  }
  set_n_threads(n_before);
  for (const CellId c : ids<CellId>(bodies[0].grid.n_cells())) {
    ASSERT_EQ(grid::cell_point(bodies[0], c), grid::cell_point(bodies[1], c));
    for (const auto f : bodies[0].grid.faces(c))
      ASSERT_EQ(grid::face_point(bodies[0], f), grid::face_point(bodies[1], f));
  }
}

} // namespace
} // namespace kerf::cut::fit_test
