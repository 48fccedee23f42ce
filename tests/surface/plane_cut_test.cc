/// A box cut by planes, against the exact volumes on both sides.
///
/// The total is exact for every plane. The pieces are where the lattice resolves the plane; elsewhere a crossing is
/// lost in the layer between the skin and the last nodes, because an edge is cut once.

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

/// The one material node among these vertices (bits) of a cell; invalid when there are none or more.
grid::NodeId only_material(const grid::Grid& grid, const CellId c, const unsigned vertices) {
  grid::NodeId only;
  int n_found = 0;
  for (int v = 0; v < 8; ++v)
    if ((vertices >> v & 1) && grid.is_material(grid.nodes(c)[v])) {
      only = grid.nodes(c)[v];
      ++n_found;
    }
  return n_found == 1 ? only : grid::NodeId();
}

/// Where a plane cannot be told from the lattice: it crosses the part of a skin edge that is material (that edge is cut
/// already), or passes between a node and the sharp edge or corner of the box that only this node has in a face or
/// cell.
std::size_t n_unresolved(const Body& body, const Plane& plane) {
  const grid::Grid& grid = body.grid;
  const auto parted = [&](const grid::NodeId n, const Vec3& p) {
    return (plane.height(grid.position(n)) < 0) != (plane.height(p) < 0);
  };
  std::size_t n = 0;
  for (const EdgeCut& cut : body.cuts.all()) {
    const auto& [lower, upper] = grid.ends(cut.edge);
    n += parted(grid.is_material(lower) ? lower : upper, grid::edge_point(grid, body.cuts, cut.edge));
  }
  for (const auto c : ids<CellId>(grid.n_cells())) {
    if (const auto node = only_material(grid, c, 0xff); node.valid())
      n += parted(node, grid::cell_point(grid, body.cuts, c));
    for (int face = 0; face < 6; ++face)
      if (const auto node = only_material(grid, c, grid::cube::face_mask(face)); node.valid())
        n += parted(node, grid::face_point(grid, body.cuts, grid.faces(c)[face]));
  }
  return n;
}

/// Volume of the pieces on the lower side of a plane that cut them all.
double cut_volume_below(const Body& body, const Plane& plane) {
  const auto complex = grid::build_complex(body.grid, body.cuts);
  const grid::Pieces pieces = grid::pieces(complex);
  EXPECT_LE(pieces.n_pieces, 2u);
  const auto volumes = piece_volumes(build_surface(body.grid, body.cuts, complex), complex);
  std::vector<bool> is_below(pieces.n_pieces, false);
  for (const auto n : ids<grid::NodeId>(body.grid.n_nodes()))
    if (body.grid.is_material(n) && plane.height(body.grid.position(n)) < 0)
      for (const auto c : ids<CopyId>(complex.n_copies()))
        if (const auto& copy = complex.copies[c]; complex.real_corner[n] == copy.corners[0] && (copy.nodes & 1))
          is_below[pieces.piece[c]] = true;
  double below = 0;
  for (std::uint32_t p = 0; p < pieces.n_pieces; ++p)
    below += is_below[p] ? volumes[p] : 0;
  return below;
}

double total_volume(const Body& body) {
  const auto volumes = support::octant_volumes(body, grid::build_complex(body.grid, body.cuts));
  return std::accumulate(volumes.begin(), volumes.end(), 0.0);
}

struct PlaneStudy {
  std::size_t n_planes = 0, n_resolved = 0, n_held = 0; ///< held: resolved, with vertices that stop at a side
  double worst_total = 0, worst_resolved = 0;           ///< errors relative to the box
  double worst_other = 0;                               ///< in cells a place that is not resolved
};

void study_plane(PlaneStudy& study, Body body, const Plane& plane) {
  const double exact = support::volume_below(box, plane), whole = (box.upper - box.lower).prod();
  const std::size_t unresolved = n_unresolved(body, plane);
  const auto counts = support::cut(body, support::plane_cuts(body, plane));
  const double error = std::abs(cut_volume_below(body, plane) - exact);
  study.worst_total = std::max(study.worst_total, std::abs(total_volume(body) / whole - 1));
  ++study.n_planes;
  if (unresolved > 0) {
    const double cells = std::pow(body.grid.h(), 3) * static_cast<double>(unresolved);
    study.worst_other = std::max(study.worst_other, error / cells);
    return;
  }
  ++study.n_resolved;
  study.n_held += counts.n_clamped > 0;
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
    std::cout << name << ": " << s.n_planes << " planes, " << s.n_resolved << " resolved (" << s.n_held
              << " with vertices at sides), worst piece volume error " << s.worst_resolved << "; others at most "
              << s.worst_other << " cells a lost crossing; total volume within " << s.worst_total << '\n';
  EXPECT_EQ(along_axes.n_resolved, 150u);
  EXPECT_LT(along_axes.worst_resolved, 1e-12);
  EXPECT_LT(tilted.worst_resolved, 1e-12);
  EXPECT_GT(tilted.n_resolved, 200u);
  EXPECT_GT(tilted.n_held, 100u);
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
    support::cut(body, support::plane_cuts(body, plane));
    sum += std::abs(support::volume_below(body, plane) - support::volume_below(box, plane));
  }
  return sum / n_planes / (box.upper - box.lower).prod();
}

/// What the lattice loses under the skin is a sliver of a part of h^3 in each of the cells along the rim, about 1/h of
/// them: no worse than h^2. On opposite sides of the box slivers go to opposite parts, so most of it cancels.
TEST(PlaneCut, LosesLittleWhereTheLatticeDoesNotResolveIt) {
  constexpr int n_planes = 150;
  const std::array<double, 3> spacings = {0.1, 0.05, 0.025};
  double before = 0;
  for (const double h : spacings) {
    const double error = mean_error(h, n_planes), rate = std::log2(before / error);
    std::cout << "h = " << h << ": mean error of a part " << error << " of the box";
    if (before > 0) {
      std::cout << ", order " << rate;
      EXPECT_GT(rate, 2.0);
    }
    std::cout << '\n';
    before = error;
  }
  EXPECT_LT(before, 6.8e-5);
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
      support::cut(body, pending.release(body.grid, body.cuts));
    EXPECT_GT(n_steps, 1);
    worst = std::max(worst, std::abs(cut_volume_below(body, plane) - support::volume_below(box, plane)));
  }
  EXPECT_LT(worst, 1e-12 * (box.upper - box.lower).prod());
}

} // namespace
} // namespace kerf::surface
