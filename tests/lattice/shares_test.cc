/// What corners carry, against the integrals that the elements take and against the octants themselves.

#include "lattice/shares.h"
#include "fem/hexahedra.h"
#include "tests/lattice/bodies.h"
#include "tests/support/placed.h"

#include <gtest/gtest.h>

#include <set>

namespace kerf::lattice::shares_test {
namespace {

Body rough_block(const unsigned seed, const fem::Interval& t) {
  Draw draw(seed);
  Body body = fem::make_block({4, 3, 3}, 0.1, draw, t);
  fem::cut_at_random(body, 0.3, draw, t);
  return body;
}

/// The integral of N_a from moments of the material: products of x or 1 - x along each axis.
double shape_integral(const fem::Moments& m, const int a) {
  double sum = 0;
  for (int i = 0; i < 8; ++i) { // which factors give their x
    double factor = 1;
    for (int axis = 0; axis < 3; ++axis) {
      const bool takes_x = (i >> axis & 1) != 0, is_upper = (a >> axis & 1) != 0;
      factor *= takes_x ? (is_upper ? 1 : -1) : (is_upper ? 0 : 1);
    }
    sum += factor * m[(i & 1) + 3 * (i >> 1 & 1) + 9 * (i >> 2 & 1)];
  }
  return sum;
}

/// Moments come from a quadrature of monomials; here it is products in barycentric coordinates.
TEST(Shares, CornersWeighTheIntegralsOfTheirShapeFunctions) {
  const Body body = rough_block(10, {0.02, 0.98});
  std::vector<double> mass(body.complex.n_corners(), 0.0), expected = mass;
  for (const Share& share : material_shares(body, 1100))
    mass[share.corner.value] += share.mass;
  for (const grid::Copy& copy : body.complex.copies) {
    const auto moments = fem::material_moments(body, copy);
    for (int a = 0; a < 8; ++a)
      expected[copy.corners[a].value] +=
        1100 * 1e-3 * std::max(copy.nodes == 0xff ? 1.0 / 8 : shape_integral(moments, a), 0.0);
  }
  for (std::size_t c = 0; c < mass.size(); ++c)
    EXPECT_NEAR(mass[c], expected[c], 1e-12 * 1100 * 1e-3) << c;
}

/// Sum and first moments of each piece are those of its octants: sum of N_a X_a is the point itself.
TEST(Shares, MassAndCentreAreTheMaterials) {
  const Body body = rough_block(11, {1e-9, 1});
  const double h = body.grid.h(), density = 900;
  const grid::Pieces pieces = grid::pieces(body.complex);
  std::vector<double> mass(pieces.n_pieces, 0.0), share_mass = mass;
  Points moment(pieces.n_pieces, Vec3::Zero()), share_moment = moment;
  std::vector<std::uint32_t> piece(body.complex.n_corners());
  for (const auto c : ids<grid::CopyId>(body.complex.n_copies())) {
    const grid::Copy& copy = body.complex.copies[c];
    for (const grid::CornerId corner : copy.corners)
      piece[corner.value] = pieces.piece[c];
    grid::for_each_tetrahedron(body, copy, [&](const grid::Tetrahedron& t, int) {
      const double m = density * h * h * h * support::volume(t);
      mass[pieces.piece[c]] += m;
      moment[pieces.piece[c]] += m * (body.grid.origin(copy.cell) + h / 4 * (t[0] + t[1] + t[2] + t[3]));
    });
  }
  const Points rest = body.rest();
  for (const Share& share : material_shares(body, density)) {
    share_mass[piece[share.corner.value]] += share.mass;
    share_moment[piece[share.corner.value]] += share.mass * rest[share.corner.value];
  }
  for (std::uint32_t p = 0; p < pieces.n_pieces; ++p) {
    EXPECT_NEAR(share_mass[p], mass[p], 1e-12 * density * h * h * h);
    EXPECT_LT((share_moment[p] - moment[p]).norm(), 1e-12 * density * h * h * h);
  }
}

/// A sliver of 1e-9 of an edge puts 1e-27 on the corner opposite: exact, in relation to itself.
TEST(Shares, FarCornersOfSliversAreExact) {
  for (const double a : {1.0, 1e-3, 1e-9}) {
    const grid::Tetrahedron t = {Vec3(0, 0, 0), Vec3(a, 0, 0), Vec3(0, a, 0), Vec3(0, 0, a)};
    // the integral of x y z over it is a^6 / 720
    EXPECT_NEAR(grid::shape_integrals(t)[7] / (std::pow(a, 6) / 720), 1, 1e-13);
    double sum = 0;
    for (const double integral : grid::shape_integrals(t))
      sum += integral;
    EXPECT_NEAR(sum / (a * a * a / 6), 1, 1e-13);
  }
}

TEST(Shares, EveryCornerAndEveryNodeHasSome) {
  const Body body = rough_block(12, {1e-9, 1});
  std::set<grid::NodeId> nodes;
  std::set<grid::CornerId> corners;
  for (const Share& share : material_shares(body, 1000)) {
    EXPECT_GT(share.mass, 0);
    EXPECT_TRUE(body.grid.is_material(share.node));
    nodes.insert(share.node);
    corners.insert(share.corner);
  }
  EXPECT_EQ(corners.size(), body.complex.n_corners());
  EXPECT_EQ(nodes.size(), 36u);
}

/// Of bodies with a jagged skin that planes have cut: also corners with next to nothing have some mass, and each copy has
/// its own.
TEST(Shares, OfAJaggedSkinArePositive) {
  support::Random random(6);
  for (int i = 0; i < 400; ++i) {
    auto body =
      support::embedded(geometry::sphere_mesh(0.4, Vec3::Constant(0.5), 1), 0.15, support::random_offset(random));
    for (grid::CutLabel label = 1; label <= 3; ++label) {
      const Vec3 normal = support::random_direction(random);
      const Vec3 through = Vec3::Constant(0.5) + 0.2 * support::random_vector(random);
      support::cut_through(body, support::cuts_of_plane(body, {normal, normal.dot(through)}, label));
    }
    double found = 0, expected = 0;
    for (const Share& share : material_shares(body, 1000)) {
      EXPECT_GT(share.mass, 0) << i;
      found += share.mass;
    }
    for (const grid::Copy& copy : body.complex.copies)
      expected += 1000 * std::pow(body.grid.h(), 3) * grid::fill(body, copy);
    EXPECT_NEAR(found, expected, 1e-9 * expected) << i;
  }
}

} // namespace
} // namespace kerf::lattice::shares_test
