/// Affine patch test: under u = A X the nodal forces of a cut body are the tractions on its surface, integrated by
/// another rule over the surface's own triangles.

#include "fem/corotational.h"

#include "dynamics/state.h"
#include "surface/surface.h"
#include "tests/fem/bodies.h"
#include "tests/fem/quadrature.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

namespace kerf::fem {
namespace {

const material::Elastic rubber{.density = 1000, .youngs_modulus = 1, .poissons_ratio = 0.35};

Mat3 stress(const Mat3& A) {
  const Mat3 strain = 0.5 * (A + A.transpose());
  return rubber.lambda() * strain.trace() * Mat3::Identity() + 2 * rubber.mu() * strain;
}

/// Internal forces of the displacement u = A X at R = I.
Points nodal_forces(const Body& body, const Mat3& A) {
  Corotational model(body.grid, body.cuts, body.complex, {.material = rubber, .sliver_floor = 0});
  Points u = body.rest(), forces(u.size());
  for (Vec3& p : u)
    p = A * p;
  model.apply_stiffness(dynamics::flat(u), dynamics::flat(forces));
  return forces;
}

/// For each corner, the integral of N sigma n over the surface of its copies.
Points tractions(const Body& body, const surface::Surface& skin, const Mat3& sigma) {
  static const auto rule = triangle_rule(3);
  Points sum(body.complex.n_corners(), Vec3::Zero());
  for (std::size_t i = 0; i < skin.triangles.size(); ++i) {
    const grid::Copy& copy = body.complex.copies[skin.copies[i]];
    const Vec3 p = skin.rest[skin.triangles[i][0]];
    const Vec3 a = skin.rest[skin.triangles[i][1]] - p, b = skin.rest[skin.triangles[i][2]] - p;
    const Vec3 traction = sigma * a.cross(b); // the area twice; the rule's weights sum to 1/2
    const Vec3 origin = body.grid.origin(copy.cell);
    for (const auto& [x, weight] : rule) {
      const Vec3 local = (p + x[0] * a + x[1] * b - origin) / body.grid.h();
      for (int v = 0; v < 8; ++v)
        sum[copy.corners[v].value] += weight * shape(v, local) * traction;
    }
  }
  return sum;
}

/// The largest nodal force that is not a traction, over sigma h^2.
double patch_error(const Body& body, const Mat3& A) {
  const auto skin = surface::build_surface(body.grid, body.cuts, body.complex);
  const Mat3 sigma = stress(A);
  const Points forces = nodal_forces(body, A), expected = tractions(body, skin, sigma);
  double error = 0;
  for (std::size_t c = 0; c < forces.size(); ++c)
    error = std::max(error, (forces[c] - expected[c]).norm());
  return error / (sigma.norm() * body.grid.h() * body.grid.h());
}

/// The largest force on a node away from the skin, summed over all its corners, over sigma h^2.
double imbalance(const Body& body, const Mat3& A, const grid::CellId middle) {
  const Points forces = nodal_forces(body, A);
  Points sum(body.grid.n_nodes(), Vec3::Zero());
  for (const auto c : ids<grid::CornerId>(body.complex.n_corners()))
    sum[body.complex.node[c].value] += forces[c.value];
  double worst = 0;
  for (const auto node : body.grid.nodes(middle))
    worst = std::max(worst, sum[node.value].norm());
  return worst / (stress(A).norm() * body.grid.h() * body.grid.h());
}

/// One cell of a 3 x 3 x 3 block; its lines are cut anywhere on their edges, with any normals. The cells of the block's
/// skin are there too: nothing is left out.
TEST(Patch, EveryConfigurationOfACellInABlock) {
  Draw draw(21);
  const Body block = make_block({4, 4, 4}, 0.3, draw, {0.3, 0.7});
  const auto middle = *block.grid.find_cell({2, 2, 2});
  double worst = 0, worst_sum = 0;
  for (unsigned configuration = 0; configuration < 4096; ++configuration) {
    Body body = block;
    std::vector<grid::EdgeCut> cuts;
    for (int line = 0; line < 12; ++line)
      if (configuration >> line & 1)
        cuts.push_back({body.grid.edges(middle)[line], draw(0, 1), draw.vector().normalized(), 1});
    body.cut(cuts);
    const Mat3 A = draw.matrix();
    worst = std::max(worst, patch_error(body, A));
    worst_sum = std::max(worst_sum, imbalance(body, A, middle));
    ASSERT_LT(worst, 1e-10) << configuration;
    ASSERT_LT(worst_sum, 1e-10) << configuration;
  }
  RecordProperty("worst", std::to_string(worst * 1e14) + "e-14");
  RecordProperty("worst_sum", std::to_string(worst_sum * 1e14) + "e-14");
}

TEST(Patch, BodiesCutAtRandom) {
  Draw draw(22);
  for (const double probability : {0.1, 0.3, 0.6, 1.0})
    for (int n = 0; n < 5; ++n) {
      Body body = make_block({3, 4, 3}, 0.1, draw, {0, 1});
      cut_at_random(body, probability, draw, {0, 1});
      cut_at_random(body, 0.3, draw, {0, 1}); // later cuts move what the first ones placed
      EXPECT_LT(patch_error(body, draw.matrix()), 1e-10);
    }
}

/// The other way to count a copy fails on purpose: as a full cube it carries more than its tractions.
TEST(Patch, FullCubesDoNotPass) {
  Draw draw(23);
  Body body = make_block({2, 2, 2}, 1, draw, {0.4, 0.4});
  const Mat3 A = draw.matrix();
  const Corotational model(body.grid, body.cuts, body.complex,
                           {.material = rubber, .integration = Integration::full_cube, .sliver_floor = 0});
  Points u = body.rest(), forces(u.size());
  for (Vec3& p : u)
    p = A * p;
  model.apply_stiffness(dynamics::flat(u), dynamics::flat(forces));
  const auto skin = surface::build_surface(body.grid, body.cuts, body.complex);
  const Points expected = tractions(body, skin, stress(A));
  double error = 0;
  for (std::size_t c = 0; c < forces.size(); ++c)
    error = std::max(error, (forces[c] - expected[c]).norm());
  EXPECT_GT(error, 0.1 * stress(A).norm());
}

} // namespace
} // namespace kerf::fem
