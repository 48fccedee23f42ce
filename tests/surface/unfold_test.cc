#include "surface/unfold.h"

#include "surface/view.h"
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

/// A liver that a sphere cuts, as far as the middle of it.
struct CutLiver {
  Body body = support::embedded(support::liver_mesh(), 0.012, Vec3(0.3, 0.6, 0.1));
  grid::CutChange change;

  CutLiver() {
    body.complex = grid::build_complex(body);
    const Points rest = grid::rest_positions(body);
    cut::Cutter cutter(1);
    cutter.begin(body, rest);
    change = cutter.at_once(body, {"sphere", cut::Sphere{rest.front(), 0.1}, 1}, rest);
    surface::place(body, change, {});
  }
};

/// Every second vertex of the cut in a face goes anywhere in that.
void misplace_vertices(Body& body, support::Random& random) {
  for (const CellId c : ids<CellId>(body.grid.n_cells()))
    for (int face = 0; face < 6; ++face)
      for (const int arc : {0, 1})
        if (const grid::FaceId f = body.grid.faces(c)[face]; body.cuts.inner_point(f, arc) && random() % 2 == 0) {
          Vec3 p = *body.cuts.inner_point(f, arc);
          for (int axis = 0; axis < 3; ++axis)
            if (axis != grid::cube::face_axis(face))
              p[axis] = body.grid.origin(c)[axis] + body.grid.h() * support::uniform(random, 0.05, 0.95);
          body.cuts.set_inner_point(f, arc, p);
        }
}

TEST(Unfold, LeavesNoPartWithLessThanNothing) {
  support::Random random(7);
  Body body = CutLiver().body;
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
  unfold(body, cells);
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

TEST(Unfold, LeavesGoodVerticesWhereTheyAre) {
  const CutLiver liver;
  Body body = liver.body;
  std::vector<CellId> cells = liver.change.cells;
  unfold(body, cells);
  EXPECT_EQ(cells, liver.change.cells);
  for (const CellId c : cells)
    EXPECT_EQ(material(body, c), material(liver.body, c));
}

} // namespace
} // namespace kerf::surface::unfold_test
