/// Bodies put anywhere, and bodies ground to dust.

#include "lattice/shape_matching.h"
#include "tests/lattice/bodies.h"
#include "tests/support/parents.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

namespace kerf::lattice::robustness_test {
namespace {

constexpr double dt = 1.0 / 60;

/// How a block was mistreated.
enum class Mistreatment { point, line, plane, inverted, scrambled };

/// How far from its rest shape: the largest change of the distance of two material nodes, over h.
double shape_error(const Body& body, const Points& x) {
  const Points rest = body.rest();
  double worst = 0;
  for (const auto a : body.complex.real_corner)
    for (const auto b : body.complex.real_corner)
      if (a.valid() && b.valid())
        worst = std::max(worst, std::abs((x[a.value] - x[b.value]).norm() - (rest[a.value] - rest[b.value]).norm()));
  return worst / body.grid.h();
}

/// The error that is left after n steps of a block of 4^3 nodes.
double error_after(const int n_steps, const Mistreatment mistreatment, const int w, const unsigned seed) {
  Draw draw(seed);
  const Body body = fem::make_block({4, 4, 4}, 0.1, draw, {0.3, 0.7});
  const Matching model(body, matching_options({.half_width = w}, 1000, dt));
  ShapeMatching stepper(model, 5);
  dynamics::State state{body.rest(), Points(body.complex.n_corners(), Vec3::Zero()), 0};
  const Vec3 middle = body.grid.position(*body.grid.find_node({2, 2, 2}));
  for (Vec3& x : state.x) {
    if (mistreatment == Mistreatment::scrambled)
      x = middle + 0.5 * Vec3(draw(-1, 1), draw(-1, 1), draw(-1, 1));
    if (mistreatment == Mistreatment::point)
      x = middle;
    if (mistreatment == Mistreatment::line)
      x = Vec3(middle[0], middle[1], x[2]);
    if (mistreatment == Mistreatment::plane)
      x[2] = middle[2];
    if (mistreatment == Mistreatment::inverted)
      x[2] = 2 * middle[2] - x[2];
  }
  for (int i = 0; i < n_steps; ++i)
    stepper.step(state, {.mass_damping = 1, .supports = {}}, dt);
  return shape_error(body, state.x);
}

TEST(Robustness, ComesBackFromAPointALineAPlaneAndInsideOut) {
  for (const auto mistreatment : {Mistreatment::point, Mistreatment::line, Mistreatment::plane, Mistreatment::inverted})
    for (const int w : {1, 2, 3, 8})
      EXPECT_LT(error_after(2000, mistreatment, w, 80), 1e-2) << "w " << w << ", " << static_cast<int>(mistreatment);
}

TEST(Robustness, ScramblesComeUndone) {
  for (const int w : {1, 2, 3, 8}) {
    int n = 0;
    for (unsigned seed = 81; seed < 97; ++seed) {
      const double error = error_after(1000, Mistreatment::scrambled, w, seed);
      EXPECT_TRUE(std::isfinite(error));
      n += error < 1e-2;
    }
    EXPECT_EQ(n, 16) << w;
  }
}

Points inherited(const Points& values, const Table<grid::CornerId, grid::CornerId>& parents) {
  Points result;
  for (const auto parent : parents)
    result.push_back(values[parent.value]);
  return result;
}

Points momenta_of_pieces(const Body& body, const Matching& model, const dynamics::State& state) {
  const grid::Pieces pieces = grid::pieces(body.complex);
  Points sum(pieces.n_pieces, Vec3::Zero());
  std::vector<std::uint8_t> seen(state.x.size(), 0);
  for (const auto c : ids<grid::CopyId>(body.complex.n_copies()))
    for (const auto corner : body.complex.copies[c].corners)
      if (!seen[corner.value]++)
        sum[pieces.piece[c]] += model.lumped_mass()[corner.value] * state.v[corner.value];
  return sum;
}

/// Cells around these edges hold no empty node.
std::vector<grid::EdgeId> edges_inside(const Body& body) {
  std::vector<grid::EdgeId> edges;
  for (const auto e : fem::inner_edges(body)) {
    bool is_inside = true;
    for (const auto c : body.grid.cells(e))
      for (int v = 0; v < 8; ++v)
        is_inside = is_inside && c.valid() && body.grid.is_material(body.grid.nodes(c)[v]);
    if (is_inside)
      edges.push_back(e);
  }
  return edges;
}

/// Where cells were whole, the shares of their copies sum to what was there before: momenta and kinetic energy stay.
TEST(Robustness, AFirstCutMovesNoMass) {
  Draw draw(97);
  Body body = fem::make_block({5, 5, 5}, 0.1, draw, {0.2, 0.8});
  dynamics::State state{body.rest(), {}, 0};
  for (const Vec3& x : state.x)
    state.v.push_back(Vec3(1, 2, 3).cross(x) + 0.3 * draw.vector());
  const Matching whole(body, matching_options({}, 1000, dt));
  const Momentum before = momentum(whole.lumped_mass(), state.x, state.v);
  const double kinetic = kinetic_energy(whole.lumped_mass(), state.v);
  const grid::CellComplex complex = body.complex;
  std::vector<grid::EdgeCut> cuts;
  for (const auto e : edges_inside(body))
    cuts.push_back({e, draw(0.01, 0.99), draw.vector().normalized(), 1});
  body.cut(cuts);
  ASSERT_GT(body.complex.n_copies(), complex.n_copies() + 20);
  const auto parents = support::parents(complex, body);
  state.x = inherited(state.x, parents);
  state.v = inherited(state.v, parents);
  const Matching model(body, matching_options({}, 1000, dt));
  const Momentum after = momentum(model.lumped_mass(), state.x, state.v);
  EXPECT_LT((after.linear - before.linear).norm(), 1e-12 * before.linear.norm());
  EXPECT_LT((after.angular - before.angular).norm(), 1e-12 * before.angular.norm());
  EXPECT_NEAR(kinetic_energy(model.lumped_mass(), state.v), kinetic, 1e-12 * kinetic);
}

/// How a body is ground.
struct Mill {
  int half_width, n_nodes, n_rounds, n_steps; ///< along an axis; in a round
  double part;                                ///< of the edges cut in a round, all of them in the last
};

/// Spins and shakes without damping while its edges are cut at places anywhere, down to single nodes. The energy never
/// exceeds what it was at first, but for the swing of symplectic Euler: cuts themselves leave both energies alone, up
/// to 15 % of the elastic one (material changes regions, and corners of hardly any mass have none of it) and 1 % of the
/// kinetic one (a later cut moves the point where the octants of a cell meet, and with it mass from copy to copy).
void expect_to_survive(const Mill& mill) {
  Draw draw(98);
  Body body = fem::make_block({mill.n_nodes, mill.n_nodes, mill.n_nodes}, 0.1, draw, {0.1, 0.9});
  const auto make = [&] {
    return std::make_unique<Matching>(body, matching_options({.half_width = mill.half_width}, 1000, dt));
  };
  dynamics::State state{body.rest(), {}, 0};
  for (const Vec3& x : state.x)
    state.v.push_back(Vec3(1, 2, 3).cross(x) + 0.3 * draw.vector());
  auto model = make();
  const auto kinetic = [&] { return kinetic_energy(model->lumped_mass(), state.v); };
  const double start = model->energy(state.x) + kinetic();
  double most = start;
  for (int round = 1; round <= mill.n_rounds; ++round) {
    const double E = model->energy(state.x), T = kinetic();
    const grid::CellComplex before = body.complex;
    fem::cut_at_random(body, round < mill.n_rounds ? mill.part : 2, draw, {1e-9, 1});
    const auto parents = support::parents(before, body);
    state.x = inherited(state.x, parents);
    state.v = inherited(state.v, parents);
    model = make();
    EXPECT_LT(model->energy(state.x), 1.15 * E + 1e-9 * start) << round;
    EXPECT_NEAR(kinetic(), T, 0.01 * T) << round;
    const Points momenta = momenta_of_pieces(body, *model, state);
    ShapeMatching stepper(*model, 0);
    for (int i = 0; i < mill.n_steps; ++i) {
      stepper.step(state, {.supports = {}}, dt);
      most = std::max(most, model->energy(state.x) + kinetic());
    }
    const Points after = momenta_of_pieces(body, *model, state);
    for (std::size_t p = 0; p < momenta.size(); ++p)
      EXPECT_LT((after[p] - momenta[p]).norm(), 1e-11 * (momenta[p].norm() + 1e-3));
  }
  EXPECT_LT(most, 1.1 * start);
  EXPECT_TRUE(std::isfinite(model->energy(state.x)));
  EXPECT_EQ(grid::n_pieces(body.complex), static_cast<std::uint32_t>(std::pow(mill.n_nodes, 3)));
}

TEST(Robustness, DustCarriesOn) {
  expect_to_survive({.half_width = 1, .n_nodes = 6, .n_rounds = 40, .n_steps = 10, .part = 1.0 / 12});
  expect_to_survive({.half_width = 4, .n_nodes = 6, .n_rounds = 40, .n_steps = 10, .part = 1.0 / 12});
}

/// 11,520 edges.
TEST(Robustness, TenThousandCutsCarryOn) {
  expect_to_survive({.half_width = 2, .n_nodes = 16, .n_rounds = 12, .n_steps = 3, .part = 0.3});
}

} // namespace
} // namespace kerf::lattice::robustness_test
