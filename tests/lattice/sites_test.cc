/// Pieces that hold no node have points, regions and a motion of their own.

#include "lattice/sites.h"

#include "cut/at_skin.h"
#include "lattice/matching.h"
#include "surface/placement.h"
#include "tests/lattice/bodies.h"
#include "tests/support/bodies.h"

#include <gtest/gtest.h>

namespace kerf::lattice {
namespace {

/// A block whose lid a plane has cut off between its last nodes and its skin, 0.2 cubes thick: rinds alone.
support::Body lidded() {
  support::Body body = support::block({4, 3, 3});
  const Vec3 normal = Vec3(0.02, 0.01, 1).normalized();
  std::vector<grid::EdgeId> edges;
  for (const auto& cut : support::plane_cuts(body, {normal, normal.dot(Vec3(2, 2, 3.3))})) {
    body.cuts.add(body.grid, cut);
    edges.push_back(cut.edge);
  }
  cut::part_skin(body, edges);
  surface::place(body, {});
  body.complex = grid::build_complex(body);
  return body;
}

/// Whether a corner is the lid's.
std::vector<std::uint8_t> lid(const support::Body& body, const Sites& sites) {
  std::vector<std::uint8_t> is_lid(body.complex.n_corners(), 0);
  for (const auto c : sites.loose)
    for (const auto corner : body.complex.copies[c].corners)
      is_lid[corner.value] = 1;
  return is_lid;
}

TEST(Sites, AreTheNodesAndTheCopiesOfPiecesWithoutOne) {
  const support::Body body = lidded();
  ASSERT_EQ(grid::n_pieces(body.complex), 2u);
  const Sites sites = sites_of(body);
  EXPECT_EQ(sites.nodes.size(), 36u);
  EXPECT_EQ(sites.loose.size(), 5u * 4u); // the cubes above the last layer of 4 x 3 nodes, and half ones around them
  for (const auto c : sites.loose)
    EXPECT_EQ(body.complex.copies[c].nodes, 0);
}

/// In the lid as in the block, a region of half width 1 is three points wide, fewer at its rims; none holds points of both.
TEST(Sites, HaveRegionsInTheirPieceAlone) {
  const support::Body body = lidded();
  const Lines lines(body, 1);
  const std::size_t n_nodes = lines.sites().nodes.size();
  std::vector<double> ones(6 * lines.n_points(), 0.0);
  for (std::size_t p = n_nodes; p < lines.n_points(); ++p)
    ones[6 * p] = 1;
  lines.sum_over_regions(ones);
  double most = 0;
  for (std::size_t p = 0; p < lines.n_points(); ++p) {
    if (p < n_nodes) {
      EXPECT_EQ(ones[6 * p], 0);
    } else {
      EXPECT_GE(ones[6 * p], 4) << "a corner of the lid";
    }
    most = std::max(most, ones[6 * p]);
  }
  EXPECT_EQ(most, 9);
}

/// However far and however turned the lid is, nothing draws it to the block.
TEST(Sites, ForcesOfALidThatIsCutOffAreItsOwn) {
  const support::Body body = lidded();
  const Matching model(body, {.density = 1000, .half_width = 2, .stiffness = 3600});
  const auto is_lid = lid(body, model.lines().sites());
  const Points rest = grid::rest_positions(body);
  Draw draw(5);
  const Mat3 turn = draw.rotation();
  Points x = rest, forces;
  for (std::size_t i = 0; i < x.size(); ++i)
    if (is_lid[i])
      x[i] = turn * x[i] + Vec3(30, 40, -50);
  model.force(x, forces);
  const double scale = 3600 * 1000; // k times the mass of a cube, for a metre
  for (const Vec3& f : forces)
    EXPECT_LT(f.norm(), 1e-10 * scale);

  for (Vec3& p : x)
    p += 0.2 * draw.vector();
  model.force(x, forces);
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
  for (std::size_t i = 0; i < x.size(); ++i)
    if (is_lid[i]) {
      force += forces[i];
      torque += x[i].cross(forces[i]);
    }
  EXPECT_LT(force.norm(), 1e-11 * scale);
  EXPECT_LT(torque.norm(), 1e-9 * scale);
}

} // namespace
} // namespace kerf::lattice
