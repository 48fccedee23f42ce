/// A box cut by planes, against the exact volumes on both sides.
///
/// The total is exact for every plane. So are the pieces, but where the plane cuts a tip off a sharp edge of the box
/// between the lattice's edges.

#include "cut/pending.h"
#include "grid/cube.h"
#include "tests/support/cut_by_plane.h"

#include <gtest/gtest.h>

#include <iostream>
#include <numbers>
#include <numeric>

namespace kerf::surface {
namespace {

using grid::CellId;
using grid::CopyId;
using grid::EdgeCut;
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

/// Where a plane cannot be told from the lattice: it cuts the tip off the skin's line in a face, or off its fan in a
/// cell, and no edge; or its rim bends at two sharp edges in one cell.
std::size_t n_unresolved(const Body& body, const Plane& plane) {
  const auto is_below = [&](const Vec3& p) { return plane.height(p) < 0; };
  std::size_t n = 0;
  for (const auto c : ids<CellId>(body.grid.n_cells())) {
    const grid::CellCuts cell = grid::cuts_of(body, c);
    const auto edges = body.grid.edges(c);
    const auto faces = body.grid.faces(c);
    const auto skin_at = [&](const int line) { return grid::edge_point(body, edges[line]); };
    std::size_t n_ends = 0, n_below = 0, n_bends = 0;
    for (int line = 0; line < 12; ++line)
      if (cell.skin >> line & 1) {
        ++n_ends;
        n_below += is_below(skin_at(line));
      }
    for (int face = 0; face < 6; ++face)
      for (const grid::SkinArc& arc : grid::skin_arcs(face, cell.material)) {
        const bool tip = is_below(grid::face_point(body, faces[face]));
        n += is_below(skin_at(arc.lines[0])) != tip && is_below(skin_at(arc.lines[1])) != tip;
        ++n_ends;
        n_below += tip;
        if (arc.vertices[0] == arc.vertices[1])
          n_bends += tip != is_below(grid::cell_point(body, c));
      }
    const bool tip = is_below(grid::cell_point(body, c));
    n += n_bends > 1;
    n += n_ends > 0 && n_below == (tip ? 0 : n_ends);
  }
  return n;
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

struct PlaneStudy {
  std::size_t n_planes = 0, n_resolved = 0;
  double worst_total = 0, worst_resolved = 0; ///< errors relative to the box
  double worst_other = 0;                     ///< in cells a place that is not resolved
};

void study_plane(PlaneStudy& study, Body body, const Plane& plane) {
  const double exact = support::volume_below(box, plane), whole = (box.upper - box.lower).prod();
  const std::size_t unresolved = n_unresolved(body, plane);
  support::cut_through(body, support::cuts_of_plane(body, plane));
  const double error = std::abs(cut_volume_below(body, plane) - exact);
  study.worst_total = std::max(study.worst_total, std::abs(total_volume(body) / whole - 1));
  ++study.n_planes;
  if (unresolved > 0) {
    const double cells = std::pow(body.grid.h(), 3) * static_cast<double>(unresolved);
    study.worst_other = std::max(study.worst_other, error / cells);
    return;
  }
  ++study.n_resolved;
  study.worst_resolved = std::max(study.worst_resolved, error / whole);
}

TEST(PlaneCut, GivesExactVolumesWhereTheLatticeResolvesIt) {
  Random random(35);
  PlaneStudy along_axes, tilted;
  const Points normals = tilts();
  for (int i = 0; i < 50; ++i) {
    const Body body = support::embedded(geometry::box_mesh(box.lower, box.upper), 0.1, random_offset(random));
    ASSERT_NEAR(support::surface_volume(body), (box.upper - box.lower).prod(), 1e-13);
    for (std::size_t k = 0; k < normals.size(); ++k) {
      const Vec3 through = 0.5 * (box.lower + box.upper) + 0.1 * (i - 24.5) / 50 * Vec3::Ones();
      study_plane(k < 3 ? along_axes : tilted, body, {normals[k], normals[k].dot(through)});
    }
  }
  for (const auto& [name, s] : {std::pair("axes", along_axes), std::pair("tilted", tilted)})
    std::cout << name << ": " << s.n_planes << " planes, " << s.n_resolved << " resolved, worst piece volume error "
              << s.worst_resolved << "; others at most " << s.worst_other << " cells a lost tip; total volume within "
              << s.worst_total << '\n';
  EXPECT_EQ(along_axes.n_resolved, 150u);
  EXPECT_LT(along_axes.worst_resolved, 1e-12);
  EXPECT_LT(tilted.worst_resolved, 1e-12);
  EXPECT_GT(tilted.n_resolved, 700u);
  EXPECT_LT(tilted.worst_other, 0.5) << "where the lattice cannot tell the plane";
  EXPECT_LT(std::max(along_axes.worst_total, tilted.worst_total), 1e-12);
}

/// Mean error of the part below random planes, relative to the box.
double mean_error(const double h, const int n_planes) {
  Random random(37);
  double sum = 0;
  for (int i = 0; i < n_planes; ++i) {
    Body body = support::embedded(geometry::box_mesh(box.lower, box.upper), h, random_offset(random));
    const Vec3 normal = support::random_direction(random);
    const Vec3 through = 0.5 * (box.lower + box.upper) + 0.05 * support::random_vector(random);
    const Plane plane{normal, normal.dot(through)};
    support::cut_through(body, support::cuts_of_plane(body, plane));
    sum += std::abs(support::volume_below(body, plane) - support::volume_below(box, plane));
  }
  return sum / n_planes / (box.upper - box.lower).prod();
}

/// What the lattice loses is a tip of a part of h^3 where the plane passes an edge of the box, at a few places: third
/// order.
TEST(PlaneCut, LosesTipsOfSharpEdges) {
  constexpr int n_planes = 150;
  for (const double h : {0.1, 0.05, 0.025}) {
    const double cube = h * h * h / (box.upper - box.lower).prod(), error = mean_error(h, n_planes);
    std::cout << "h = " << h << ": mean error of a part " << error << " of the box, " << error / cube << " cells\n";
    EXPECT_LT(error, 0.02 * cube);
  }
}

TEST(PlaneCut, IsAsExactInManySteps) {
  Random random(36);
  double worst = 0;
  for (int i = 0; i < 20; ++i) {
    Body body = support::embedded(geometry::box_mesh(box.lower, box.upper), 0.1, random_offset(random));
    const Plane plane{Vec3::Unit(i % 3), uniform(random, 0.15, 0.4)};
    auto cuts = support::plane_cuts(body, plane);
    std::shuffle(cuts.begin(), cuts.end(), random);
    cut::PendingCuts pending;
    pending.push(cuts);
    int n_steps = 0;
    for (; pending.size() > 0; ++n_steps)
      support::cut_through(body, pending.release(body));
    EXPECT_GT(n_steps, 1);
    worst = std::max(worst, std::abs(cut_volume_below(body, plane) - support::volume_below(box, plane)));
  }
  EXPECT_LT(worst, 1e-12 * (box.upper - box.lower).prod());
}

} // namespace
} // namespace kerf::surface
