/// Planes and blades that open dents of a jagged skin from behind: what lies on one side of a cut around a dent, and
/// the skin of the dent, are one, so that no copy bounds less than nothing.

#include "cut/dents.h"
#include "tests/cut/least_material.h"
#include "tests/cut/patient.h"
#include "tests/cut/unit_solids.h"
#include "tests/support/cut_by_plane.h"

#include <gtest/gtest.h>

namespace kerf::cut::dents_test {
namespace {

support::Plane random_plane(Random& random, const geometry::TriangleMesh& mesh) {
  const Vec3 normal = random_direction(random);
  return {normal, normal.dot(mesh.vertices[random() % mesh.vertices.size()] * 0.6 +
                             mesh.vertices[random() % mesh.vertices.size()] * 0.4)};
}

/// All items of some lie on one side of a plane.
bool is_on_one_side(const Body& body, const grid::CellId c, const grid::Items items, const support::Plane& plane) {
  bool is_above = false, is_below = false;
  for (grid::Items left = items; left != 0; left &= left - 1)
    (plane.height(grid::item_point(body, c, std::countr_zero(left))) > 0 ? is_above : is_below) = true;
  return is_above != is_below;
}

TEST(Dents, AreOneWithWhatIsAroundThem) {
  std::size_t n = 0;
  LeastMaterial least;
  for (const auto& [name, mesh] : unit_solids(folder_of_meshes()))
    for (unsigned seed = 0; seed < 60; ++seed) {
      Random random(seed);
      Body body = support::embedded(mesh, 1 / uniform(random, 8, 16), random_offset(random));
      const support::Plane plane = random_plane(random, mesh);
      support::cut_through(body, support::cuts_of_plane(body, plane));
      least.look_at(body);
      for (const auto c : ids<grid::CellId>(body.grid.n_cells()))
        for (const Dent& dent : dents(body, c)) { // as segments alone part the cell
          ++n;
          EXPECT_TRUE(is_on_one_side(body, c, dent.joined().items, plane))
            << name << ", " << seed << ", cell " << c.value;
        }
    }
  std::cout << n << " dents; " << least << '\n';
  EXPECT_GT(n, 10u);
  EXPECT_GT(least.n_copies, 10000u);
  EXPECT_GT(least.of_copies, -round_off);
  EXPECT_GT(least.at_corners, -round_off);
  EXPECT_GE(least.of_squares, least_square);
}

} // namespace
} // namespace kerf::cut::dents_test
