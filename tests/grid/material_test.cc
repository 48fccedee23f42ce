/// The tetrahedra that fill cells: octants, and what cuts at the skin leave of a cell.

#include "grid/material.h"

#include "tests/grid/histories.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <bit>
#include <numeric>

namespace kerf::grid::material_test {
namespace {

using support::Body;
using support::Random;
using support::uniform;

/// A number between 0 and 1, in the margins of the allowed range one time in three.
double anywhere(Random& random) {
  const int which = std::uniform_int_distribution<int>(0, 5)(random);
  return which == 0 ? min_edge_parameter : which == 1 ? 1 - min_edge_parameter : uniform(random, 0.001, 0.999);
}

TEST(Octants, TileTheirCellForEveryPositionOfThePoints) {
  Random random(3);
  const double h = 0.1;
  const Body blank = support::block({2, 2, 2}, h);
  const CellId c = *blank.grid.find_cell({1, 1, 1});
  for (int i = 0; i < 2000; ++i) {
    Body body{blank.grid, Cuts(blank.grid)};
    for (const EdgeId e : blank.grid.edges(c))
      if (uniform(random, 0, 1) < 0.8)
        body.cuts.add(blank.grid, {e, anywhere(random), Vec3::UnitX(), 1});
    const auto random_point = [&] {
      return Vec3(blank.grid.origin(c) + h * Vec3(anywhere(random), anywhere(random), anywhere(random)));
    };
    for (int face = 0; face < 6; ++face) {
      Vec3 p = random_point();
      p[face / 2] = blank.grid.origin(c)[face / 2] + (face & 1 ? h : 0);
      body.cuts.set_point(blank.grid.faces(c)[face], p);
    }
    body.cuts.set_point(c, random_point());
    double sum = 0;
    for (int v = 0; v < 8; ++v)
      for (const auto& t : octant(body, c, v)) {
        ASSERT_GT(volume(t), 0) << "cell " << i << " octant " << v;
        sum += volume(t);
      }
    ASSERT_NEAR(sum, 1, 1e-13);
  }
}

TEST(Octants, OfAnUncutCellAreEighths) {
  const Body body = support::block({2, 2, 2}, 0.25);
  const CellId c = *body.grid.find_cell({1, 1, 1});
  for (int v = 0; v < 8; ++v) {
    double sum = 0;
    for (const auto& t : octant(body, c, v)) {
      sum += volume(t);
      for (const Vec3& p : t)
        for (int axis = 0; axis < 3; ++axis)
          EXPECT_LE(std::abs(p[axis] - (v >> axis & 1)), 0.5);
    }
    EXPECT_NEAR(sum, 0.125, 1e-15);
  }
}

using Masses = std::array<double, 8>;

/// Adds the mass of a tetrahedron at each vertex of its cell, by a rule that is exact for trilinear shape functions.
void add_mass(const Tetrahedron& t, Masses& mass) {
  const Vec3 centre = 0.25 * (t[0] + t[1] + t[2] + t[3]);
  const auto add = [&](const Vec3& p, const double weight) {
    for (int v = 0; v < 8; ++v)
      mass[v] += weight * (v & 1 ? p[0] : 1 - p[0]) * (v & 2 ? p[1] : 1 - p[1]) * (v & 4 ? p[2] : 1 - p[2]);
  };
  add(centre, -0.8 * volume(t));
  for (const Vec3& p : t)
    add(centre + (p - centre) / 3, 0.45 * volume(t));
}

/// Of all copies of a cell.
Masses masses(const Body& body, const CellId c) {
  Masses sum{};
  for (const CopyId copy : body.complex.copies_of(c))
    for_each_tetrahedron(body, body.complex.copies[copy], [&](const Tetrahedron& t, int) { add_mass(t, sum); });
  return sum;
}

double total(const Masses& mass) { return std::accumulate(mass.begin(), mass.end(), 0.0); }

/// Of a face's normal.
int axis_of(const Grid& grid, const FaceId f) {
  const auto& [below, above] = grid.cells(f);
  const auto faces = grid.faces(below.valid() ? below : above);
  return static_cast<int>(std::ranges::find(faces, f) - faces.begin()) / 2;
}

/// Nodes at random, the skin anywhere.
Body random_body(Random& random, const double h) {
  auto nodes = support::some_nodes(random, {2, 2, 2}, uniform(random, 0.2, 0.9));
  nodes.push_back({1, 1, 1});
  Body body = support::make_body({{0.3, -2, 7}, h}, nodes, [&](const Grid& grid, const EdgeId e) {
    EdgeCut cut = support::midway(grid, e);
    cut.t = anywhere(random);
    return cut;
  });
  for (const auto f : ids<FaceId>(body.grid.n_faces())) {
    Vec3 p = centre(body.grid, f);
    for (int axis = 0; axis < 3; ++axis)
      p[axis] += axis == axis_of(body.grid, f) ? 0 : h * uniform(random, -0.5, 0.5);
    body.cuts.set_point(f, p);
  }
  for (const auto c : ids<CellId>(body.grid.n_cells()))
    body.cuts.set_point(c, centre(body.grid, c) + h * (support::random_offset(random) - Vec3::Constant(0.5)));
  return body;
}

/// Vertices of cuts anywhere in the planes of their sides, and in cells.
void place_anywhere(Random& random, Body& body, const double probability) {
  const double h = body.grid.h();
  const auto is_placed = [&] { return uniform(random, 0, 1) < probability; };
  for (const auto f : ids<FaceId>(body.grid.n_faces()))
    for (const int arc : {0, 1})
      if (is_placed()) {
        Vec3 p = centre(body.grid, f);
        for (int axis = 0; axis < 3; ++axis)
          p[axis] += axis == axis_of(body.grid, f) ? 0 : h * uniform(random, -1, 1);
        body.cuts.set_inner_point(f, arc, p);
      }
  for (const auto c : ids<CellId>(body.grid.n_cells())) {
    const Skeleton& skeleton = skeleton_of(material_of(body.grid, c));
    for (int triangle = 0; triangle < skeleton::n_sides - skeleton::first_triangle; ++triangle)
      if (const Skeleton::Side& side = skeleton.side[skeleton::first_triangle + triangle]; side.n == 3 && is_placed()) {
        const Vec3 p = item_point(body, c, side.items[0]), q = item_point(body, c, side.items[1]);
        body.cuts.set_inner_point(
          c, triangle,
          p + uniform(random, -0.5, 1) * (q - p) + uniform(random, -0.5, 1) * (item_point(body, c, side.items[2]) - p));
      }
    if (is_placed())
      body.cuts.set_inner_point(c, centre(body.grid, c) + h * (support::random_offset(random) - Vec3::Constant(0.5)));
  }
}

/// Wherever the blades cut and their vertices lie: what they leave of a cell is the cell, and so at each of its
/// corners.
TEST(Material, OfTheCopiesOfACellIsThatOfTheCell) {
  Random random(31);
  std::size_t n_cells = 0, n_parts = 0;
  double worst = 0;
  for (int i = 0; i < 150; ++i) {
    Body body = support::with_copies(random_body(random, uniform(random, 0.05, 2)));
    std::vector<Masses> before;
    for (const auto c : ids<CellId>(body.grid.n_cells()))
      before.push_back(masses(body, c));
    const double density = uniform(random, 0, 1);
    for (int cut = 0; cut < 3; ++cut) { // later cuts keep it too
      const auto plan = histories::random_plan(random, body, density, density, density);
      histories::apply(plan, body);
      place_anywhere(random, body, cut == 2 ? 1 : 0.4);
      body.complex = build_complex(body);
      for (const auto c : ids<CellId>(body.grid.n_cells())) {
        const Masses now = masses(body, c);
        ASSERT_NEAR(total(now), total(before[c.value]), 1e-12);
        for (int v = 0; v < 8; ++v) {
          ASSERT_NEAR(now[v], before[c.value][v], 1e-12);
          worst = std::max(worst, std::abs(now[v] - before[c.value][v]));
        }
        ++n_cells;
        for ([[maybe_unused]] const CopyId copy : body.complex.copies_of(c))
          ++n_parts;
      }
    }
  }
  RecordProperty("worst", std::to_string(worst));
  EXPECT_GT(n_cells, 5000u);
  EXPECT_GT(n_parts, 4 * n_cells);
}

/// Each piece belongs to a vertex that has material, and reaches from an item of the part.
TEST(Material, IsOfItsPart) {
  Random random(33);
  for (int i = 0; i < 50; ++i) {
    Body body = random_body(random, 0.3);
    histories::apply(histories::random_plan(random, body, 0.3, 0.5, 0.5), body);
    for (const auto c : ids<CellId>(body.grid.n_cells())) {
      const CellCuts cuts = cuts_of(body, c);
      if (!cuts.is_cut_at_skin())
        continue;
      std::size_t n = 0;
      for (const Part& part : parts_of(cuts))
        for (const auto& [t, vertex] : pieces_of(body, c, part.items())) {
          ++n;
          bool is_item = false;
          for (Items left = part.items(); left != 0; left &= left - 1) {
            const int item = std::countr_zero(left);
            const Vec3 p = (item_point(body, c, item) - body.grid.origin(c)) / body.grid.h();
            is_item |= cuts.skeleton().vertex[item] == vertex && (t[0] - p).norm() < 1e-12;
          }
          ASSERT_TRUE(is_item);
          ASSERT_TRUE(cuts.material >> vertex & 1);
        }
      ASSERT_EQ(n, 4u * static_cast<unsigned>(std::popcount(cuts.skeleton().segments)))
        << "two ends and two sides of each segment";
    }
  }
}

/// A block with a plane skin, cut by planes: what lies below them, in closed form.
TEST(Material, OfAPlaneCutIsExact) {
  Body body = support::block({1, 1, 1}); // the box from 0.5 to 1.5
  const support::Plane plane{Vec3::UnitX(), 1.2};
  histories::apply({support::plane_cuts(body, plane), support::plane_skin_cuts(body, plane)}, body);
  body.complex = build_complex(body);
  const Pieces all = pieces(body.complex);
  ASSERT_EQ(all.n_pieces, 2u);
  std::array<double, 2> volumes{};
  for (const auto c : ids<CopyId>(body.complex.n_copies()))
    volumes[all.piece[c]] += fill(body, body.complex.copies[c]);
  EXPECT_NEAR(std::max(volumes[0], volumes[1]), 0.7, 1e-14);
  EXPECT_NEAR(std::min(volumes[0], volumes[1]), 0.3, 1e-14);
}

} // namespace
} // namespace kerf::grid::material_test
