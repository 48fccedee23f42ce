#include "surface/unfold.h"

#include "base/sort_unique.h"
#include "grid/parts.h"
#include "surface/sight.h"
#include "tests/cut/cutting.h"
#include "tests/cut/least_material.h"
#include "tests/support/placed.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

namespace kerf::surface::unfold_test {
namespace {

using grid::CellId;
using support::Body;

/// At each corner, of all copies of a cell [h^3].
using Material = std::vector<std::array<double, 8>>;

Material material(const Body& body, const CellId c) {
  Material result;
  for (const grid::CopyId copy : body.complex.copies_of(c)) {
    auto& at_corner = result.emplace_back();
    grid::for_each_tetrahedron(body, body.complex.copies[copy], [&](const grid::Tetrahedron& t, int) {
      const auto integrals = grid::shape_integrals(t);
      for (int v = 0; v < 8; ++v)
        at_corner[v] += integrals[v];
    });
  }
  return result;
}

bool has_less_than_nothing(const Body& body, const CellId c) {
  cut::LeastMaterial least;
  for (const grid::CopyId copy : body.complex.copies_of(c))
    least.look_at(body, body.complex.copies[copy]);
  return least.at_corners < -cut::round_off || least.of_squares < cut::least_square;
}

/// A liver that something cuts.
struct CutLiver {
  Body body = support::embedded(support::liver_mesh(), 0.012, Vec3(0.3, 0.6, 0.1));
  grid::CutChange change;

  explicit CutLiver(const cut::Shape& shape) {
    body.complex = grid::build_complex(body);
    const Points rest = grid::rest_positions(body);
    cut::Cutter cutter(1);
    cutter.begin(body, rest);
    change = cutter.at_once(body, {"", shape, 1}, rest);
    surface::place(body, change, {});
  }
};

const cut::Plane plane{{0.13, 0.1, 0.12}, Vec3(1, 2, 3).normalized()};

/// Each vertex of the cut in a face goes anywhere in that.
void misplace_vertices(Body& body, support::Random& random) {
  for (const CellId c : ids<CellId>(body.grid.n_cells()))
    for (int face = 0; face < 6; ++face)
      for (const int arc : {0, 1})
        if (const grid::FaceId f = body.grid.faces(c)[face]; body.cuts.inner_point(f, arc)) {
          Vec3 p = *body.cuts.inner_point(f, arc);
          for (int axis = 0; axis < 3; ++axis)
            if (axis != grid::cube::face_axis(face))
              p[axis] = body.grid.origin(c)[axis] + body.grid.h() * support::uniform(random, 0.05, 0.95);
          body.cuts.set_inner_point(f, arc, p);
        }
}

class Unfold : public testing::TestWithParam<cut::Shape> {};

TEST_P(Unfold, LeavesNoPartWithLessThanNothing) {
  support::Random random(7);
  Body body = CutLiver(GetParam()).body;
  misplace_vertices(body, random);
  std::map<CellId, Material> before;
  std::vector<CellId> cells;
  for (const CellId c : ids<CellId>(body.grid.n_cells())) {
    before.emplace(c, material(body, c));
    if (has_less_than_nothing(body, c))
      cells.push_back(c);
  }
  const std::size_t n = cells.size();
  EXPECT_GT(n, 5);
  EXPECT_EQ(unfold(body, cells), 0);
  EXPECT_GT(cells.size(), n);
  EXPECT_TRUE(std::ranges::is_sorted(cells));
  cut::LeastMaterial least;
  least.look_at(body);
  EXPECT_GE(least.of_copies, -cut::round_off);
  EXPECT_GE(least.at_corners, -cut::round_off);
  EXPECT_GE(least.of_squares, cut::least_square);
  for (const auto& [c, of_cell] : before) // and says of which cells the material has another shape
    if (!std::ranges::binary_search(cells, c)) {
      EXPECT_EQ(material(body, c), of_cell);
    }
}

/// As the cuts of a plane do, where a vertex has left it.
TEST(UnfoldInAPlane, BringsVerticesBackToIt) {
  support::Random random(7);
  Body body = CutLiver(plane).body;
  misplace_vertices(body, random);
  const Body before = body;
  std::vector<CellId> cells;
  for (const CellId c : ids<CellId>(body.grid.n_cells()))
    if (has_less_than_nothing(body, c))
      cells.push_back(c);
  EXPECT_EQ(unfold(body, cells), 0);
  std::size_t n = 0;
  for (const CellId c : cells)
    for (const grid::FaceId f : body.grid.faces(c))
      for (const int arc : {0, 1})
        if (const Vec3* const p = body.cuts.inner_point(f, arc); p && *p != *before.cuts.inner_point(f, arc)) {
          EXPECT_NEAR(height(*p, {plane.point, plane.normal}), 0, 1e-9 * body.grid.h());
          ++n;
        }
  EXPECT_GT(n, 10);
}

TEST_P(Unfold, LeavesGoodVerticesWhereTheyAre) {
  const CutLiver liver(GetParam());
  Body body = liver.body;
  std::vector<CellId> cells = liver.change.cells;
  unfold(body, cells);
  EXPECT_EQ(cells, liver.change.cells);
  for (const CellId c : cells)
    EXPECT_EQ(material(body, c), material(liver.body, c));
}

/// Where vertices lie that have less than nothing beside them once another cut comes.
TEST_P(Unfold, JoinsTheChangeThatAllElseFollows) {
  for (const cut::Fronts fronts : {cut::Fronts::at_faces, cut::Fronts::of_elements}) {
    support::Random random(7);
    const CutLiver liver(GetParam());
    Body body = liver.body;
    Points at_skin;
    for (const CellId c : liver.change.cells)
      if (const Vec3* const p = body.cuts.inner_point(c))
        at_skin.push_back(*p);
    const Vec3 rim = at_skin[at_skin.size() / 2];
    misplace_vertices(body, random);
    cut::Cutting cutting(std::move(body), fronts);
    const Points rest = grid::rest_positions(cutting.body);
    grid::CutChange change = cutting.cutter.at_once(
      cutting.body, {"later", cut::Disc{rim, Vec3(1, 0.2, -1).normalized(), 0.06}, 2}, rest);
    const auto is_front = [&](const CellId c) { return cutting.body.cuts.front(c) != nullptr; };
    EXPECT_EQ(std::ranges::any_of(change.cells, is_front), fronts == cut::Fronts::of_elements);
    const std::vector<CellId> cells = change.cells;
    cutting.follow(change);
    EXPECT_GT(change.cells.size(), cells.size());
    EXPECT_TRUE(std::ranges::includes(change.cells, cells));
    EXPECT_TRUE(std::ranges::is_sorted(change.reshaped));
    std::vector<grid::CopyId> copies;
    for (const CellId c : change.cells)
      for (const grid::CopyId copy : cutting.body.complex.copies_of(c))
        copies.push_back(copy);
    sort_unique(copies);
    EXPECT_TRUE(std::ranges::includes(change.reshaped, copies));
    cut::expect_as_built(cutting);
  }
}

/// Of bodies in disorder, where fronts part cells in which nothing is cut yet, and meet lines beyond the skin.
TEST(UnfoldAtAFront, LeavesNoPartWithLessThanNothing) {
  std::ptrdiff_t n_placed = 0;
  for (const unsigned seed : {877u, 1328u, 1423u}) {
    support::Random random(seed);
    Body body = support::embedded(support::liver_mesh(), 0.02, support::random_offset(random));
    body.complex = grid::build_complex(body);
    cut::Cutting cutting(body, cut::Fronts::of_elements);
    Points x = grid::rest_positions(body);
    for (Vec3& p : x)
      for (double& coordinate : p)
        coordinate += 1.2 * body.grid.h() * support::uniform(random, -1, 1);
    const Vec3 middle = x[random() % x.size()];
    const cut::Disc disc{middle, support::random_direction(random), support::uniform(random, 0.02, 0.08)};
    cutting.follow(cutting.cutter.at_once(cutting.body, {"", disc, 1}, x));
    cut::LeastMaterial least;
    least.look_at(cutting.body);
    EXPECT_GE(least.at_corners, -cut::round_off) << seed;
    EXPECT_GE(least.of_squares, cut::least_square) << seed;
    n_placed += std::ranges::count_if(cutting.body.complex.copies, [&](const grid::Copy& copy) {
      return grid::cuts_of(cutting.body, copy.cell).blades == 0 && cutting.body.cuts.inner_point(copy.cell) != nullptr;
    });
  }
  EXPECT_GT(n_placed, 0);
}

INSTANTIATE_TEST_SUITE_P(Of, Unfold,
                         testing::Values(cut::Shape(cut::Sphere{{0.05, 0.1, 0.046}, 0.08}),
                                         cut::Shape(plane)),
                         [](const auto& of) { return of.index == 0 ? "ASphere" : "APlane"; });

} // namespace
} // namespace kerf::surface::unfold_test
