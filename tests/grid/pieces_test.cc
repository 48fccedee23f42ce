/// Pieces that follow cuts are those that are found from scratch.

#include "grid/complex.h"
#include "tests/grid/histories.h"
#include "tests/support/bodies.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace kerf::grid::pieces_test {
namespace {

using histories::Plan;
using support::Body;
using support::Random;
using support::uniform;

/// Follows steps; returns after how many of them nothing but what is around a cut was looked at.
std::size_t follow(std::vector<Plan> steps, Body& body, const bool cuts_skin_above = false) {
  std::size_t n_local = 0;
  Pieces all = pieces(body.complex);
  for (Plan& step : steps) {
    histories::apply(step, body);
    if (cuts_skin_above) {
      step.of_skin = support::skin_cuts_above(body);
      histories::apply({{}, step.of_skin}, body);
    }
    const CutChange change = update_complex(body, step.edges(), step.segments());
    n_local += update_pieces(body, change, all) ? 1 : 0;
    const Pieces anew = pieces(body.complex);
    EXPECT_EQ(all.n_pieces, anew.n_pieces);
    EXPECT_TRUE(std::ranges::equal(all.piece, anew.piece));
  }
  return n_local;
}

TEST(Pieces, AreThoseFromScratchAfterAnyCuts) {
  Random random(11);
  std::size_t n_local = 0, n_pieces = 0, n = 0;
  for (int i = 0; i < 120; ++i) {
    Body body = support::with_copies(support::block({2 + i % 4, 2 + i / 4 % 3, 2 + i % 2}));
    const Plan plan = histories::random_plan(random, body, uniform(random, 0.2, 1), uniform(random, 0, 0.5),
                                             uniform(random, 0, 0.5));
    n_local += follow(histories::dealt(random, plan, 8), body);
    n_pieces += grid::n_pieces(body.complex);
    n += 8;
  }
  EXPECT_GT(n_local, n / 20) << "the sets are too wild";
  EXPECT_LT(n_local, n - n / 20) << "the sets are too tame";
  EXPECT_GT(n_pieces, 300u) << "the sets are too tame";
}

/// A blade that goes through a body: nothing but what is around it is looked at, until the halves come free.
TEST(Pieces, OfABodyThatIsSlitAreFoundAroundTheCut) {
  Random random(12);
  Body body = support::with_copies(support::block({14, 8, 6}));
  Plan plan;
  for (const auto e : ids<EdgeId>(body.grid.n_edges()))
    if (const auto [lower, upper] = body.grid.ends(e); body.grid.axis(e) == 1 && body.grid.is_material(lower) &&
                                                       body.grid.is_material(upper) && body.grid.index(lower)[1] == 4)
      plan.cuts.push_back({e, uniform(random, 0.2, 0.8), Vec3::UnitY(), 1});
  std::vector<Plan> steps;
  const auto along = [&](const EdgeCut& cut) { return body.grid.index(body.grid.ends(cut.edge)[0])[0]; };
  std::ranges::sort(plan.cuts, {}, along);
  for (const EdgeCut& cut : plan.cuts) {
    if (steps.empty() || along(steps.back().cuts[0]) != along(cut))
      steps.emplace_back();
    steps.back().cuts.push_back(cut);
  }
  EXPECT_GE(follow(steps, body, true) + 3, steps.size());
  EXPECT_EQ(n_pieces(body.complex), 2u);
}

} // namespace
} // namespace kerf::grid::pieces_test
