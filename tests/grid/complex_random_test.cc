/// The complex of copies against a slow one made from the definitions of grid/complex.h, built and brought up to date,
/// on random cut sets and on embedded bodies.

#include "cut/embed.h"
#include "geometry/solid.h"
#include "tests/geometry/meshes.h"
#include "tests/grid/complex_changes.h"
#include "tests/support/checkout.h"

#include <gtest/gtest.h>

namespace kerf::grid::complex_random_test {
namespace {

struct Tally {
  std::size_t n_pieces = 0, n_without_nodes = 0, n_held_by_skin = 0, n_with_skin = 0;

  void add(const Body& body, const CellComplex& complex) {
    n_pieces += grid::n_pieces(complex);
    for (const Copy& copy : complex.copies) {
      n_without_nodes += copy.nodes == 0;
      n_with_skin += copy.nodes != 0 && copy.skin != 0;
      if (copy.nodes != 0)
        n_held_by_skin +=
          copy.nodes != cube::reachable(std::countr_zero(copy.nodes), body.cuts.configuration(body.grid, copy.cell));
    }
  }
};

CellComplex check(Random& random, const Body& body, const Plan& plan) {
  const Body cut = histories::applied(plan, body);
  const CellComplex complex = build_complex(cut);
  expect_consistent(cut, complex);
  expect_matches_slow(cut, complex);
  expect_pieces_of_material(cut, complex);
  Plan other = plan;
  std::shuffle(other.cuts.begin(), other.cuts.end(), random);
  std::shuffle(other.of_skin.begin(), other.of_skin.end(), random);
  expect_same(complex, build_complex(histories::applied(other, body)));
  const std::size_t n_steps = 1 + random() % std::max<std::size_t>(1, std::min<std::size_t>(6, plan.size()));
  expect_updates(random, body, plan, n_steps);
  return complex;
}

TEST(Complex, AgreesWithItsDefinitionOnRandomCutSets) {
  Random random(4);
  std::size_t n_cut_sets = 0;
  Tally tally;
  for (int i = 0; i < 300; ++i) {
    const Index3 n = {2 + i % 4, 1 + i / 4 % 4, 1 + i / 16 % 4};
    auto nodes = i % 2 == 0 ? support::block_nodes(n) : support::some_nodes(random, n, 0.7);
    if (nodes.empty())
      nodes = {{1, 1, 1}};
    const Body body = support::make_body({}, nodes, support::midway);
    const double inner = uniform(random, 0.02, 0.98);
    const Plan plan = histories::random_plan(random, body, inner, 0, i % 4 == 0 ? 0 : inner);
    tally.add(body, check(random, body, plan));
    ASSERT_FALSE(HasFatalFailure()) << "random set " << i;
    n_cut_sets += plan.cuts.empty() ? 0 : 1;
  }
  EXPECT_GT(n_cut_sets, 250u);
  EXPECT_GT(tally.n_pieces, 1500u) << "the sets are too tame";
}

TEST(Complex, AgreesWithItsDefinitionOnCutsOfTheSkin) {
  Random random(6);
  Tally tally;
  for (int i = 0; i < 600; ++i) {
    const Index3 n = {1 + i % 4, 1 + i / 4 % 3, 1 + i / 12 % 3};
    auto nodes = i % 4 == 0 ? support::block_nodes(n) : support::some_nodes(random, n, uniform(random, 0.1, 1));
    if (nodes.empty())
      nodes = {{1, 1, 1}};
    const Body body = i % 10 == 9 ? support::ball(1, uniform(random, 0.4, 0.8), support::random_offset(random))
                                  : support::make_body({}, nodes, [&](const Grid& grid, const EdgeId e) {
                                      EdgeCut cut = support::midway(grid, e);
                                      cut.t = uniform(random, 0.01, 0.99);
                                      return cut;
                                    });
    const double inner = i % 3 == 0 ? 0 : uniform(random, 0, 1), second = uniform(random, 0, 1);
    const Plan plan = histories::random_plan(random, body, inner, second, i % 5 == 0 ? 0 : uniform(random, 0, 1));
    const CellComplex complex = check(random, body, plan);
    ASSERT_FALSE(HasFatalFailure()) << "random body " << i;
    tally.add(histories::applied(plan, body), complex);
  }
  EXPECT_GT(tally.n_pieces, 2000u) << "the sets are too tame";
  EXPECT_GT(tally.n_without_nodes, 5000u);
  EXPECT_GT(tally.n_held_by_skin, 1000u) << "nodes that only the skin holds together";
  EXPECT_GT(tally.n_with_skin, 5000u) << "skin that holds to nodes";
}

TEST(Complex, AgreesWithItsDefinitionOnEmbeddedBodies) {
  Random random(5);
  const std::string liver = support::checkout() + "/params/meshes/liver_25k.off";
  for (const auto& [mesh, h] : {std::pair(geometry::sphere_mesh(1, Vec3::Zero(), 3), 0.3),
                                std::pair(geometry::require_solid(geometry::read_mesh(liver, 1e-3), liver), 0.022)}) {
    const Body body = cut::embed(mesh, h, {0.1, 0.5, 0.7}).solid;
    for (const double probability : {0.0, 0.1, 0.5, 0.9})
      for (const double skin : {0.0, 0.4})
        check(random, body, histories::random_plan(random, body, probability, uniform(random, 0, 1), skin));
    const support::Plane plane{Vec3(1, 0.3, -0.2).normalized(), 0.12};
    check(random, body, {support::plane_cuts(body, plane), support::plane_skin_cuts(body, plane)});
    ASSERT_FALSE(HasFatalFailure());
  }
}

/// A plane through a cell, and what of its segments that plane would part and no blade has.
Front random_front(Random& random, const Body& body, const CellId c) {
  Front front{.cell = c, .normal = support::random_direction(random), .passed = 0.5};
  front.point = body.grid.origin(c) + body.grid.h() * (Vec3::Constant(0.5) + 0.3 * support::random_vector(random));
  const CellCuts cuts = cuts_of(body, c);
  for (Segments left = cuts.skeleton().segments & ~cuts.blades; left != 0; left &= left - 1) {
    const auto& [a, b] = cuts.skeleton().segment[std::countr_zero(left)].ends;
    const auto height = [&](const int item) { return front.normal.dot(item_point(body, c, item) - front.point); };
    if ((height(a) < 0) != (height(b) < 0))
      front.ahead |= left & -left;
  }
  return front;
}

/// Fronts come and are taken back here and there, while cells are cut with them and after them, in other ways than they
/// said: the copies that they parted are glued as those of a body that has never had one.
TEST(Complex, IsAsBuiltWhereFrontsAreTakenBack) {
  Random random(7);
  std::size_t n_taken_back = 0, n_lapsed = 0, n_tied = 0;
  for (int i = 0; i < 60; ++i) {
    Body body = support::with_copies(support::block({2 + i % 3, 2 + i / 3 % 2, 2}));
    const Plan plan = histories::random_plan(random, body, uniform(random, 0, 0.7), 0, uniform(random, 0, 0.3));
    for (const histories::Step& step : histories::dealt(random, plan, 6)) {
      histories::apply(step, body);
      std::vector<CellId> cells;
      for (const auto c : ids<CellId>(body.grid.n_cells()))
        if (random() % 3 == 0) {
          if (body.cuts.front(c)) {
            body.cuts.take_back_front(c);
            ++n_taken_back;
          } else
            body.cuts.set(random_front(random, body, c));
          cells.push_back(c);
        }
      update_complex(body, step.edges(), step.segments(), cells);
      const CellComplex anew = build_complex(body);
      expect_same(body.complex, anew);
      ASSERT_EQ(body.complex.tied.size(), anew.tied.size());
      ASSERT_EQ(grid::n_pieces(body.complex), grid::n_pieces(anew));
      ASSERT_FALSE(HasFatalFailure()) << "body " << i;
      n_tied += anew.tied.size();
    }
    n_lapsed += body.complex.lapsed.size();
  }
  EXPECT_GT(n_taken_back, 1000u);
  EXPECT_GT(n_lapsed, 1000u);
  EXPECT_GT(n_tied, 1000u);
}

} // namespace
} // namespace kerf::grid::complex_random_test
