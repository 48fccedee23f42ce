/// Planes cut one after the other (thesis figure 2.15 (d), (e)): each later cut slides the vertices along the earlier
/// ones, so what was flat stays flat. The thesis projects plainly, which would bend an earlier cut that the later one
/// does not meet at a right angle, and move volume from one of its sides to the other.

#include "grid/cube.h"
#include "tests/cut/patient.h"
#include "tests/support/placed.h"

#include <gtest/gtest.h>

#include <bit>
#include <iostream>
#include <map>
#include <numbers>

namespace kerf::surface::later_cuts_test {
namespace {

using grid::CellId;
using support::Body;
using support::Random;

/// Cells without an empty node, or all of them.
enum class Where { inside, everywhere };

/// What later cuts leave of earlier ones.
struct Flatness {
  std::size_t n_moved = 0;               ///< of those that were on their plane before: that are not any more
  std::size_t n_vertices = 0, n_met = 0; ///< in faces and cells of earlier cuts; of those, on their plane before
  double worst = 0;                      ///< distance of a vertex that was on its plane, afterwards [h]
};

grid::Segments cut_under(const Body& body, const CellId c, const grid::CutLabel label) {
  grid::Segments result = 0;
  for (grid::Segments left = grid::cuts_of(body, c).blades; left != 0; left &= left - 1) {
    const int segment = std::countr_zero(left);
    const grid::CutLabel of = segment < grid::skeleton::first_half
                                ? body.cuts.find(body.grid.edges(c)[segment])->label
                                : body.cuts.find(grid::skin_segment(body.grid, c, segment))->label;
    result |= grid::Segments(of == label) << segment;
  }
  return result;
}

/// The distances [h] from the plane of all vertices in the sides and cells that hold a segment cut under the label; by
/// cell and side, -1 for the cell's own.
using Heights = std::map<std::pair<CellId, int>, double>;
Heights heights(const Body& body, const grid::CutLabel label, const support::Plane& plane, const Where where) {
  Heights result;
  for (const auto c : ids<CellId>(body.grid.n_cells())) {
    if (where == Where::inside && support::is_skin_cell(body.grid, c))
      continue;
    const auto add = [&](const int side, const Vec3& p) {
      result[{c, side}] = std::abs(plane.height(p)) / body.grid.h();
    };
    const grid::Segments cut = cut_under(body, c, label);
    const auto& grid = body.grid;
    const grid::Skeleton& skeleton = grid::skeleton_of(grid::material_of(grid, c));
    const Vec3* const inner = body.cuts.inner_point(c);
    if (cut != 0)
      add(-1, inner ? *inner : grid::cell_point(body, c));
    for (grid::Sides left = skeleton.sides; left != 0; left &= left - 1) {
      const int s = std::countr_zero(left), face = s / 2;
      const auto& [n, items, segments] = skeleton.side[s];
      if (!std::any_of(segments.begin(), segments.begin() + n, [&](const int i) { return (cut >> i & 1) != 0; }))
        continue;
      const Vec3* const p = s >= grid::skeleton::first_triangle
                              ? body.cuts.inner_point(c, s - grid::skeleton::first_triangle)
                              : body.cuts.inner_point(grid.faces(c)[face], s % 2);
      add(s, p ? *p : grid::face_point(body, grid.faces(c)[face]));
    }
  }
  return result;
}

constexpr double flat = 1e-12;

/// Of those that there were before: what was left whole may be cut when others come (cut/shreds.h).
void compare(const Heights& before, const Heights& after, Flatness& result) {
  for (const auto& [place, height] : before) {
    const auto now = after.find(place);
    ASSERT_NE(now, after.end());
    ++result.n_vertices;
    if (height < flat) {
      ++result.n_met;
      result.worst = std::max(result.worst, now->second);
      result.n_moved += now->second > flat;
    }
  }
}

/// Cuts the body by the planes, and after each one looks at all the earlier ones.
void cut_one_by_one(Body body, const std::vector<support::Plane>& planes, const Where where, Flatness& result) {
  for (grid::CutLabel k = 0; k < planes.size(); ++k) {
    std::vector<Heights> before;
    for (grid::CutLabel i = 0; i < k; ++i)
      before.push_back(heights(body, i + 1, planes[i], where));
    support::cut_through(body, support::cuts_of_plane(body, planes[k], k + 1));
    for (grid::CutLabel i = 0; i < k; ++i) {
      compare(before[i], heights(body, i + 1, planes[i], where), result);
    }
  }
}

std::vector<support::Plane> planes_through(Random& random, const Vec3& p, const int n) {
  std::vector<support::Plane> planes;
  for (int i = 0; i < n; ++i) {
    const Vec3 normal = support::random_direction(random);
    planes.push_back({normal, normal.dot(p)});
  }
  return planes;
}

void print(const char* what, const Flatness& f) {
  std::cout << what << ": " << f.n_vertices << " vertices of earlier cuts; " << f.n_vertices - f.n_met
            << " never met their plane; of the others " << f.n_moved << " have left it, by at most " << f.worst
            << " h\n";
}

TEST(LaterCuts, LeaveEarlierPlanesFlatInsideTheBody) {
  Random random(51);
  const Body whole = support::with_placed_skin(support::block({7, 7, 7}));
  Flatness pairs, triples;
  for (int i = 0; i < 300; ++i) {
    const Vec3 p = Vec3::Constant(4) + 0.3 * support::random_vector(random);
    cut_one_by_one(whole, planes_through(random, p, 2), Where::inside, pairs);
    cut_one_by_one(whole, planes_through(random, p, 3), Where::inside, triples);
  }
  print("pairs of planes", pairs);
  print("triples of planes", triples);
  EXPECT_GT(triples.n_met, 100000u);
  EXPECT_EQ(pairs.n_met, pairs.n_vertices) << "the first plane is met in every cell";
  EXPECT_LT(pairs.worst, flat);
  EXPECT_LT(triples.worst, flat);
  EXPECT_LT(static_cast<double>(triples.n_vertices - triples.n_met), 0.06 * static_cast<double>(triples.n_vertices));
}

TEST(LaterCuts, LeaveEarlierPlanesFlatUnderTheSkin) {
  Random random(52);
  const Body box = support::embedded(geometry::box_mesh(Vec3::Zero(), {0.73, 0.61, 0.52}), 0.1, {0.3, 0.8, 0.1});
  const Body ball = support::embedded(geometry::sphere_mesh(0.4, Vec3::Constant(0.3), 3), 0.1, {0.2, 0.4, 0.9});
  Flatness all;
  for (int i = 0; i < 100; ++i)
    for (const Body& whole : {box, ball}) {
      const Vec3 p = Vec3::Constant(0.3) + 0.03 * support::random_vector(random);
      cut_one_by_one(whole, planes_through(random, p, 3), Where::everywhere, all);
    }
  print("skin and all", all);
  EXPECT_LT(all.n_moved, 1e-4 * all.n_met) << "a vertex leaves its plane only where the skin would fold under it";
  EXPECT_GT(static_cast<double>(all.n_met), 0.95 * static_cast<double>(all.n_vertices));
}

/// The same by blades, in steps: the skin that a later one parts around cuts of an earlier one leaves them where they
/// are.
TEST(LaterCuts, OfBladesLeaveEarlierPlanesFlat) {
  Random random(53);
  Flatness all;
  for (int i = 0; i < 60; ++i) {
    cut::Patient patient{cut::box_body(random)};
    const Vec3 middle = 0.5 * (cut::box.lower + cut::box.upper) + 0.05 * support::random_vector(random);
    std::vector<support::Plane> planes = planes_through(random, middle, 2);
    Heights before;
    for (const grid::CutLabel label : {1, 2}) {
      const cut::Frame frame = cut::across(planes[label - 1].normal, support::uniform(random, 0, 6.3));
      patient.pass(cut::straight(middle, frame.u, frame.v, 2, 2, label), 1 + i % 20,
                   i % 2 ? cut::Release::queued : cut::Release::at_once);
      if (label == 1)
        before = heights(patient.body, 1, planes[0], Where::everywhere);
    }
    compare(before, heights(patient.body, 1, planes[0], Where::everywhere), all);
  }
  print("blades", all);
  EXPECT_GT(all.n_met, 10000u);
  EXPECT_LT(all.n_moved, 1e-3 * all.n_met) << "a vertex leaves its plane only where the skin would fold under it";
}

TEST(LaterCuts, MeetWhereTheyCrossInsideTheCell) {
  // The second plane crosses the first one in the middle of a cell and cuts at least one line that the first one left
  // whole; a third one crosses both there. Then the cell's vertex is on all of them.
  const Vec3 p(4.5, 4.45, 4.55);
  for (const double degrees : {90.0, 70.0, 50.0, 46.0, 43.0}) {
    const double angle = degrees * std::numbers::pi / 180;
    const Points normals = {Vec3::UnitX(), Vec3(std::cos(angle), std::sin(angle), 0), Vec3(0.2, 0.1, 1).normalized()};
    Body body = support::with_placed_skin(support::block({7, 7, 7}));
    for (grid::CutLabel k = 1; k <= 3; ++k)
      support::cut_through(body, support::cuts_of_plane(body, {normals[k - 1], normals[k - 1].dot(p)}, k));
    const Vec3 q = grid::cell_point(body, *body.grid.find_cell({4, 4, 4}));
    for (const Vec3& n : normals)
      EXPECT_NEAR(n.dot(q - p), 0, 1e-13) << degrees << " degrees";
  }
}

} // namespace
} // namespace kerf::surface::later_cuts_test
