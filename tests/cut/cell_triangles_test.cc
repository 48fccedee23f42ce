/// Which triangles are near a cell, and which of them a line may meet: none is left out.

#include "cut/cell_triangles.h"

#include "geometry/triangle.h"
#include "tests/support/placed.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <bit>

namespace kerf::cut::cell_triangles_test {
namespace {

using support::Random;
using support::random_direction;
using support::random_vector;
using support::uniform;

FlatTriangle flat(const std::array<Vec3, 3>& corners) {
  return {(corners[1] - corners[0]).cross(corners[2] - corners[0]), corners};
}

/// Triangles of many sizes and slivers; lines across, through a corner, along a side, and of no direction.
TEST(TriangleGroup, LeavesOutNothingThatALineMeets) {
  Random random(71);
  constexpr double tolerance = 1e-3;
  int n_met = 0, n_near_plane = 0, n_left_out = 0;
  for (int i = 0; i < 20000; ++i) {
    TriangleGroup group;
    std::vector<FlatTriangle> triangles;
    for (std::size_t k = 0; k < 1 + i % TriangleGroup::most; ++k) {
      const Vec3 a = random_vector(random), b = a + uniform(random, 0.01, 2) * random_vector(random);
      const Vec3 c = k % 5 == 0 ? Vec3(0.3 * a + 0.7 * b + 1e-9 * random_vector(random)) : random_vector(random);
      triangles.push_back(flat({a, b, c}));
      group.push_back(triangles.back());
    }
    const auto& [a, b, c] = triangles.front().corners;
    Vec3 p = random_vector(random), d = random_direction(random);
    if (i % 4 == 1)
      d = (a - p).normalized();
    else if (i % 4 == 2)
      p = a + uniform(random, -1, 1) * (b - a);
    else if (i % 40 == 3)
      d.setZero();
    const std::uint32_t may_meet = group.which_may_meet(p, d, 1, tolerance);
    for (std::size_t k = 0; k < triangles.size(); ++k) {
      const bool meets = geometry::line_meets(p, d, triangles[k].corners).has_value();
      const bool is_near = std::abs(triangles[k].height(p)) <= tolerance * triangles[k].normal.norm();
      ASSERT_TRUE((may_meet >> k & 1) || !(meets || is_near)) << i << " " << k;
      n_met += meets;
      n_near_plane += is_near;
      n_left_out += !(may_meet >> k & 1);
    }
    ASSERT_LE(std::bit_width(may_meet), triangles.size());
  }
  EXPECT_GT(n_met, 10000);
  EXPECT_GT(n_near_plane, 5000);
  EXPECT_GT(n_left_out, 100000);
}

/// Every triangle that has a point in a cell is listed there, in order; and most others are not.
TEST(CellTriangles, KnowEveryTriangleInACell) {
  Random random(72);
  const auto mesh = support::liver_mesh();
  for (const double h : {0.03, 0.012}) {
    const auto body = support::embedded(mesh, h, {0.3, 0.6, 0.9});
    std::vector<grid::EdgeId> edges;
    for (const grid::EdgeCut& cut : body.cuts.all())
      edges.push_back(cut.edge);
    const auto cells = grid::touched_cells(body.grid, edges);
    const CellTriangles triangles(mesh, body.grid, cells);
    std::size_t n_listed = 0;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      EXPECT_TRUE(std::ranges::is_sorted(triangles.of(i), std::less_equal()));
      n_listed += triangles.of(i).size();
    }
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
      for (int k = 0; k < 5; ++k) {
        const auto [a, b, c] = geometry::corners(mesh, t);
        const double u = uniform(random, 0, 1), v = uniform(random, 0, 1 - u);
        const Vec3 at = (a + u * (b - a) + v * (c - a) - body.grid.lattice().origin) / h;
        const auto cell =
          body.grid.find_cell({static_cast<int>(at[0]), static_cast<int>(at[1]), static_cast<int>(at[2])});
        if (!cell)
          continue;
        const auto touched = std::ranges::lower_bound(cells, *cell, {}, &grid::TouchedCell::cell);
        if (touched != cells.end() && touched->cell == *cell) {
          ASSERT_TRUE(std::ranges::binary_search(triangles.of(touched - cells.begin()), t));
        }
      }
    EXPECT_LT(n_listed, 20 * (mesh.triangles.size() + cells.size()));
  }
}

} // namespace
} // namespace kerf::cut::cell_triangles_test
