/// Which nodes copies without one follow.

#include "grid/followed.h"

#include "tests/grid/histories.h"

#include <gtest/gtest.h>

#include <bit>
#include <map>
#include <set>
#include <utility>

namespace kerf::grid::followed_test {
namespace {

using support::Body;
using support::Random;
using support::uniform;

/// The node below the first of the copy's points of the skin.
NodeId cut_off_from(const Body& body, const Copy& copy) {
  const Skeleton& skeleton = skeleton_of(material_of(body.grid, copy.cell));
  return body.grid.nodes(copy.cell)[skeleton.vertex[std::countr_zero(copy.items())]];
}

struct Nearest {
  NodeId cut_off_from;    ///< the lowest node from which one of the copies that were reached was cut off
  std::set<NodeId> nodes; ///< of all nearest copies that have some
  int n_steps = 0;        ///< from copy to copy; two are one step apart when they have a corner in common
};

/// Goes from copy to copy.
Nearest nearest(const Body& body, const CopyId from) {
  const CellComplex& complex = body.complex;
  std::set<CopyId> reached = {from};
  Nearest result;
  for (std::size_t n_before = 0; result.nodes.empty() && reached.size() != n_before; ++result.n_steps) {
    n_before = reached.size();
    std::set<CornerId> corners;
    for (const CopyId c : reached)
      corners.insert(complex.copies[c].corners.begin(), complex.copies[c].corners.end());
    for (const auto c : ids<CopyId>(complex.n_copies())) {
      const Copy& copy = complex.copies[c];
      if (std::ranges::none_of(copy.corners, [&](const CornerId corner) { return corners.contains(corner); }))
        continue;
      reached.insert(c);
      for (int v = 0; v < 8; ++v)
        if (copy.nodes >> v & 1)
          result.nodes.insert(body.grid.nodes(copy.cell)[v]);
    }
  }
  for (const CopyId c : reached)
    if (complex.copies[c].nodes == 0)
      result.cut_off_from = std::min(result.cut_off_from, cut_off_from(body, complex.copies[c]));
  return result;
}

struct Tally {
  std::size_t n_followed = 0, n_far = 0, n_alone = 0;
};

void expect_nearest(const Body& body, Tally& tally) {
  const CellComplex& complex = body.complex;
  const auto followed = followed_nodes(body);
  std::size_t i = 0;
  for (const auto c : ids<CopyId>(complex.n_copies())) {
    if (complex.copies[c].nodes != 0)
      continue;
    ASSERT_LT(i, followed.size());
    ASSERT_EQ(followed[i].copy, c);
    const NodeId node = followed[i].node;
    ASSERT_TRUE(node.valid() && body.grid.is_material(node));
    const Nearest expected = nearest(body, c);
    if (expected.nodes.empty())
      ASSERT_EQ(node, expected.cut_off_from);
    else
      ASSERT_EQ(node, *expected.nodes.begin()) << "the lowest, in " << expected.n_steps << " steps";
    tally.n_far += !expected.nodes.empty() && expected.n_steps > 1;
    tally.n_alone += expected.nodes.empty();
    ++i;
  }
  ASSERT_EQ(i, followed.size());
  tally.n_followed += i;
}

TEST(Followed, AreTheNodesOfTheNearestCopies) {
  Random random(8);
  Tally tally;
  for (int i = 0; i < 150; ++i) {
    auto nodes = support::some_nodes(random, {4, 3, 2}, uniform(random, 0.3, 1.2));
    nodes.push_back({1, 1, 1});
    const Body blank = support::make_body({}, nodes, support::midway);
    const Body body =
      histories::applied(histories::random_plan(random, blank, uniform(random, 0, 0.5), uniform(random, 0.2, 1),
                                                random() % 2 ? uniform(random, 0, 0.3) : uniform(random, 0, 1)),
                         blank);
    expect_nearest(support::with_copies(body), tally);
    ASSERT_FALSE(HasFatalFailure()) << "random body " << i;
  }
  EXPECT_GT(tally.n_followed, 1000u);
  EXPECT_GT(tally.n_alone, 100u);
}

/// The nodes by what the copies hold, not by their names.
std::map<std::pair<CellId, Items>, NodeId> by_content(const Body& body) {
  const CellComplex& complex = body.complex;
  std::map<std::pair<CellId, Items>, NodeId> nodes;
  for (const auto& [c, node] : followed_nodes(body))
    nodes[{complex.copies[c].cell, complex.copies[c].items()}] = node;
  return nodes;
}

TEST(Followed, DoNotDependOnTheOrderOfCuts) {
  Random random(11);
  for (int i = 0; i < 100; ++i) {
    const Body blank = support::block({3, 2, 2});
    const histories::Plan plan = histories::random_plan(random, blank, 0.3, uniform(random, 0.5, 1), 0.7);
    Body body = support::with_copies(blank);
    for (const histories::Step& step : histories::dealt(random, plan, 5)) {
      histories::apply(step, body);
      update_complex(body, step.edges(), step.segments());
    }
    ASSERT_EQ(by_content(body), by_content(support::with_copies(body)));
  }
}

/// A slab whose upper skin a plane has cut off, all but at one end, or at none.
Body peeled(const int n_along, const bool at_both_ends) {
  const Body blank = support::block({n_along, 1, 1});
  const support::Plane plane{Vec3::UnitZ(), 1.2};
  histories::Plan plan{support::plane_cuts(blank, plane), support::plane_skin_cuts(blank, plane)};
  if (!at_both_ends)
    std::erase_if(plan.of_skin, [&](const SkinCut& cut) {
      const SkinSegment& at = cut.segment;
      return (at.face.valid() ? centre(blank.grid, at.face) : centre(blank.grid, at.cell))[0] < 1;
    });
  return histories::applied(plan, blank);
}

TEST(Followed, AreFoundAlongTheSkin) {
  const int n = 6;
  const Body body = support::with_copies(peeled(n, false));
  EXPECT_EQ(n_pieces(body.complex), 1u);
  const auto followed = followed_nodes(body);
  EXPECT_EQ(followed.size(), 2u * n); // in two rows of cells, but for the two at the end that holds
  const NodeId first = *body.grid.find_node({1, 1, 1});
  for (const Followed& f : followed)
    EXPECT_EQ(f.node, first) << "the only one in the cells that hold";
  Tally tally;
  expect_nearest(body, tally);
  EXPECT_GE(tally.n_far, 2u * n - 4) << "several steps";
}

TEST(Followed, AreWhatSkinWasCutOffFrom) {
  const int n = 4;
  const Body body = support::with_copies(peeled(n, true));
  EXPECT_EQ(n_pieces(body.complex), 2u);
  const auto followed = followed_nodes(body);
  EXPECT_EQ(followed.size(), 2u * (n + 1));
  for (const Followed& f : followed) {
    const int along = body.grid.index(body.grid.nodes(body.complex.copies[f.copy].cell)[0])[0];
    EXPECT_LE(along, n);
    EXPECT_EQ(f.node, *body.grid.find_node({1, 1, 1})) << "the lowest, for all of the piece";
  }
}

TEST(Followed, AreNoneWhereAllCopiesHaveNodes) {
  const Body body = support::block({2, 2, 2});
  EXPECT_TRUE(followed_nodes(support::with_copies(body)).empty());
}

} // namespace
} // namespace kerf::grid::followed_test
