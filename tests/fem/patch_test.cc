/// Affine patch test: under x = F X the nodal forces of a cut body are the tractions on its surface, integrated by
/// another rule over the surface's own triangles: for every law, and both kinds of strain.

#include "dynamics/state.h"
#include "surface/surface.h"
#include "tests/fem/models.h"
#include "tests/fem/quadrature.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

namespace kerf::fem::patch_test {
namespace {

const material::Elastic rubber{.density = 1000, .youngs_modulus = 1, .poissons_ratio = 0.35};

Mat3 stress(const Hexahedra& model, const Mat3& F) {
  return std::visit([&](const auto& law) { return Mat3(law.stress(F)); }, model.law());
}

HexahedraOptions options_of(const std::string& law, const Strain strain) {
  return {.material = with_law(rubber, law), .strain = strain};
}

/// Forces that hold the body in x = F X.
Points nodal_forces(const Hexahedra& model, const Body& body, const Mat3& F) {
  Points x = body.rest(), forces;
  for (Vec3& p : x)
    p = F * p;
  model.force(x, forces);
  for (Vec3& f : forces)
    f = -f;
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

/// The largest nodal force that is not a traction, over P h^2.
double patch_error(const Body& body, const surface::Surface& skin, const HexahedraOptions& options, const Mat3& F) {
  const Hexahedra model = make_model(body, options);
  const Mat3 P = stress(model, F);
  const Points forces = nodal_forces(model, body, F), expected = tractions(body, skin, P);
  double error = 0;
  for (std::size_t c = 0; c < forces.size(); ++c)
    error = std::max(error, (forces[c] - expected[c]).norm());
  return error / (P.norm() * body.grid.h() * body.grid.h());
}

/// The largest force on a node away from the skin, summed over all its corners, over P h^2.
double imbalance(const Body& body, const HexahedraOptions& options, const Mat3& F, const grid::CellId middle) {
  const Hexahedra model = make_model(body, options);
  const Points forces = nodal_forces(model, body, F);
  Points sum(body.grid.n_nodes(), Vec3::Zero());
  for (const auto c : ids<grid::CornerId>(body.complex.n_corners()))
    sum[body.complex.node[c].value] += forces[c.value];
  double worst = 0;
  for (const auto node : body.grid.nodes(middle))
    worst = std::max(worst, sum[node.value].norm());
  return worst / (stress(model, F).norm() * body.grid.h() * body.grid.h());
}

/// The block with the lines of one cell cut anywhere on their edges, with any normals.
Body with_configuration(const Body& block, const grid::CellId cell, const unsigned configuration, Draw& draw) {
  Body body = block;
  std::vector<grid::EdgeCut> cuts;
  for (int line = 0; line < 12; ++line)
    if (configuration >> line & 1)
      cuts.push_back({body.grid.edges(cell)[line], draw(0, 1), draw.vector().normalized(), 1});
  body.cut(cuts);
  return body;
}

Mat3 deformation(Draw& draw) { return Mat3::Identity() + 0.3 * draw.matrix(); }

/// One cell, and the cells of the skin around it: nothing is left out. A law and a strain are drawn for each
/// configuration.
TEST(Patch, EveryConfigurationOfACellUnderALaw) {
  Draw draw(20);
  const Body block = make_block({2, 2, 2}, 0.3, draw, {0.3, 0.7});
  const auto cell = *block.grid.find_cell({1, 1, 1});
  double worst = 0;
  for (unsigned configuration = 0; configuration < 4096; ++configuration) {
    const Body body = with_configuration(block, cell, configuration, draw);
    const auto one_of = [&](const auto& all) {
      return all[std::min(all.size() - 1, static_cast<std::size_t>(draw(0, static_cast<double>(all.size()))))];
    };
    const auto options = options_of(one_of(all_laws), one_of(all_strains));
    worst = std::max(worst, patch_error(body, surface::build_surface(body), options, deformation(draw)));
    ASSERT_LT(worst, 1e-10) << configuration << ' ' << name_of(options);
  }
  RecordProperty("worst", std::to_string(worst * 1e14) + "e-14");
}

/// A cell whose nodes are all away from the skin: what the copies of a node feel adds up to nothing.
TEST(Patch, ForcesOfANodesCopiesBalanceInEveryConfiguration) {
  Draw draw(21);
  const Body block = make_block({4, 4, 4}, 0.3, draw, {0.3, 0.7});
  const auto middle = *block.grid.find_cell({2, 2, 2});
  double worst = 0;
  for (unsigned configuration = 0; configuration < 4096; ++configuration) {
    const Body body = with_configuration(block, middle, configuration, draw);
    const auto options = options_of(all_laws[configuration % 4], all_strains[configuration / 4 % 2]);
    worst = std::max(worst, imbalance(body, options, deformation(draw), middle));
    ASSERT_LT(worst, 1e-10) << configuration << ' ' << name_of(options);
  }
  RecordProperty("worst", std::to_string(worst * 1e14) + "e-14");
}

TEST(Patch, BodiesCutAtRandom) {
  Draw draw(22);
  for (const double probability : {0.1, 0.3, 0.6, 1.0})
    for (const std::string& law : all_laws)
      for (const Strain strain : all_strains) {
        Body body = make_block({3, 4, 3}, 0.1, draw, {0, 1});
        cut_at_random(body, probability, draw, {0, 1});
        cut_at_random(body, 0.3, draw, {0, 1}); // later cuts move what the first ones placed
        const auto skin = surface::build_surface(body);
        EXPECT_LT(patch_error(body, skin, options_of(law, strain), deformation(draw)), 1e-10);
      }
}

/// The other ways to count a copy fail on purpose: as a full cube it carries more than its tractions, as a cube of its
/// volume it carries them elsewhere.
TEST(Patch, OtherBoundariesDoNotPass) {
  Draw draw(23);
  const Body body = make_block({2, 2, 2}, 1, draw, {0.4, 0.4});
  const auto skin = surface::build_surface(body);
  for (const Boundary boundary : {Boundary::full_cube, Boundary::volume_fraction}) {
    HexahedraOptions options = options_of("corotational", Strain::trilinear);
    options.boundary = boundary;
    EXPECT_GT(patch_error(body, skin, options, deformation(draw)), 0.02);
  }
}

} // namespace
} // namespace kerf::fem::patch_test
