/// Cuts, and where they put vertices.

#include "grid/cuts.h"

#include "tests/grid/histories.h"
#include "tests/grid/slow_parts.h"
#include "tests/support/bodies.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <map>
#include <set>
#include <stdexcept>

namespace kerf::grid::cuts_test {
namespace {

using support::Body;
using support::Random;
using support::uniform;

/// A number between 0 and 1, in the margins of the allowed range one time in three.
double anywhere(Random& random) {
  const int which = std::uniform_int_distribution<int>(0, 5)(random);
  return which == 0 ? min_edge_parameter : which == 1 ? 1 - min_edge_parameter : uniform(random, 0.001, 0.999);
}

TEST(Cuts, AreKeptByEdge) {
  Body body = support::block({2, 2, 2});
  const EdgeId e = *body.grid.find_edge({1, 1, 1}, 0);
  EXPECT_FALSE(body.cuts.is_cut(e));
  EXPECT_EQ(body.cuts.find(e), nullptr);
  EXPECT_EQ(edge_point(body, e), Vec3(1.5, 1, 1));
  const std::size_t n = body.cuts.all().size();
  body.cuts.add(body.grid, {e, 0.25, Vec3::UnitZ(), 3});
  ASSERT_NE(body.cuts.find(e), nullptr);
  EXPECT_EQ(body.cuts.find(e)->label, 3);
  EXPECT_EQ(body.cuts.find(e)->normal, Vec3(0, 0, 1));
  EXPECT_EQ(body.cuts.all().size(), n + 1);
  EXPECT_EQ(edge_point(body, e), Vec3(1.25, 1, 1));
  EXPECT_THROW(body.cuts.add(body.grid, {e, 0.5, Vec3::UnitX(), 1}), std::logic_error);
}

TEST(Cuts, MayBeTwoOnAnEdgeOfTheSkin) {
  // The skin is at 0.5 on each of them; the node is at the upper end of the first, at the lower end of the second.
  for (const bool node_is_above : {true, false}) {
    Body body = support::block({1, 1, 1});
    const EdgeId e = *body.grid.find_edge({node_is_above ? 0 : 1, 1, 1}, 0);
    const double t = node_is_above ? 0.8 : 0.2;
    EXPECT_FALSE(body.cuts.is_cut_twice(e));
    EXPECT_EQ(body.cuts.find(e), body.cuts.find_outer(e));
    EXPECT_EQ(body.cuts.index(e), body.cuts.outer_index(e));
    EXPECT_EQ(body.cuts.n_cut_twice(), 0u);
    EXPECT_TRUE(body.cuts.can_be_cut(body.grid, e));
    const std::uint32_t skin = body.cuts.index(e);
    const std::size_t n = body.cuts.all().size();

    body.cuts.add(body.grid, {e, t, Vec3::UnitZ(), 3});
    EXPECT_TRUE(body.cuts.is_cut(e));
    EXPECT_TRUE(body.cuts.is_cut_twice(e));
    EXPECT_EQ(body.cuts.n_cut_twice(), 1u);
    EXPECT_EQ(body.cuts.all().size(), n + 1);
    EXPECT_EQ(body.cuts.index(e), n);
    EXPECT_EQ(body.cuts.outer_index(e), skin);
    EXPECT_EQ(body.cuts.find(e), &body.cuts.all()[n]);
    EXPECT_EQ(body.cuts.find_outer(e), &body.cuts.all()[skin]);
    EXPECT_EQ(body.cuts.find(e)->t, t);
    EXPECT_EQ(body.cuts.find(e)->label, 3);
    EXPECT_EQ(body.cuts.find(e)->normal, Vec3(0, 0, 1));
    EXPECT_EQ(body.cuts.find_outer(e)->t, 0.5);
    EXPECT_EQ(body.cuts.find_outer(e)->label, skin_label);
    EXPECT_NEAR(edge_point(body, e)[0], node_is_above ? 0.8 : 1.2, 1e-15);
    EXPECT_EQ(edge_skin_point(body, e), Vec3(node_is_above ? 0.5 : 1.5, 1, 1));
    EXPECT_FALSE(body.cuts.can_be_cut(body.grid, e));
    EXPECT_THROW(body.cuts.add(body.grid, {e, node_is_above ? 0.9 : 0.1, Vec3::UnitX(), 1}), std::logic_error);
    EXPECT_EQ(body.cuts.all().size(), n + 1) << "refused, and left alone";
    EXPECT_EQ(body.cuts.n_cut_twice(), 1u);
  }
}

TEST(Cuts, OfTheSkinLieNowhereBelowTheSecondOne) {
  Random random(9);
  auto nodes = support::some_nodes(random, {3, 3, 3}, 0.5);
  nodes.push_back({2, 2, 2});
  const Body body = support::make_body({}, nodes, [&](const Grid& grid, const EdgeId e) {
    EdgeCut cut = support::midway(grid, e);
    cut.t = anywhere(random);
    return cut;
  });
  std::size_t n_taken = 0, n_refused = 0;
  for (const EdgeId e : body.grid.skin_edges())
    for (const double t : {-1.0, 0.0, min_edge_parameter, body.cuts.find(e)->t, uniform(random, 0, 1),
                           1 - min_edge_parameter, 1.0, 2.0}) {
      Cuts cuts = body.cuts;
      const double clamped = std::clamp(t, min_edge_parameter, 1 - min_edge_parameter), skin = cuts.find(e)->t;
      const bool is_below = body.grid.is_material(body.grid.ends(e)[0]) ? clamped <= skin : clamped >= skin;
      if (is_below) {
        cuts.add(body.grid, {e, t, Vec3::UnitX(), 1});
        EXPECT_EQ(cuts.find(e)->t, clamped);
        EXPECT_EQ(cuts.find_outer(e)->t, skin);
        ++n_taken;
      } else {
        EXPECT_THROW(cuts.add(body.grid, {e, t, Vec3::UnitX(), 1}), std::logic_error);
        EXPECT_FALSE(cuts.is_cut_twice(e));
        EXPECT_EQ(cuts.find(e)->t, skin);
        ++n_refused;
      }
    }
  EXPECT_GT(n_taken, 100u);
  EXPECT_GT(n_refused, 100u);
}

TEST(Cuts, SayWhatMayStillBeCut) {
  Random random(10);
  auto nodes = support::some_nodes(random, {4, 4, 4}, 0.6);
  Body body = support::make_body({}, nodes, support::midway);
  const auto plan = histories::random_plan(random, body, 0.4, 0.5, 0);
  std::size_t n_second = 0;
  std::map<EdgeId, int> n_cuts;
  for (const EdgeCut& cut : plan.cuts) {
    body.cuts.add(body.grid, cut);
    ++n_cuts[cut.edge];
    n_second += !support::is_inner(body, cut.edge);
  }
  EXPECT_EQ(body.cuts.n_cut_twice(), n_second);
  std::array<std::size_t, 3> n_edges{};
  for (const auto e : ids<EdgeId>(body.grid.n_edges())) {
    const auto& [lower, upper] = body.grid.ends(e);
    const int n_material = int(body.grid.is_material(lower)) + int(body.grid.is_material(upper));
    EXPECT_EQ(body.cuts.can_be_cut(body.grid, e), n_material > 0 && n_cuts[e] == 0);
    EXPECT_EQ(body.cuts.is_cut(e), n_material == 1 || n_cuts[e] > 0);
    EXPECT_EQ(body.cuts.is_cut_twice(e), n_material == 1 && n_cuts[e] > 0);
    ++n_edges[n_material];
  }
  for (const std::size_t n : n_edges)
    EXPECT_GT(n, 10u) << "edges outside, of the skin, inside";
}

SkinCut a_cut(const SkinSegment& segment, const double t, const CutLabel label) {
  return {segment, t, Vec3::UnitY(), label};
}

TEST(Cuts, OfTheSkinAreKeptBySegment) {
  Random random(11);
  auto nodes = support::some_nodes(random, {3, 3, 3}, 0.5);
  nodes.push_back({2, 2, 2});
  Body body = support::make_body({}, nodes, support::midway);
  const auto segments = histories::skin_segments(body.grid);
  EXPECT_TRUE(std::ranges::is_sorted(segments));
  std::map<SkinSegment, SkinCut> expected;
  for (const SkinCut& cut : histories::random_skin_cuts(random, body, 0.5)) {
    ASSERT_FALSE(body.cuts.is_cut(cut.segment));
    body.cuts.add(cut);
    expected[cut.segment] = cut;
    ASSERT_EQ(body.cuts.skin_cuts().size(), expected.size());
    ASSERT_EQ(body.cuts.index(cut.segment), expected.size() - 1) << "in the order in which they were added";
  }
  ASSERT_GT(expected.size(), 100u);
  for (const SkinSegment& segment : segments) {
    ASSERT_EQ(body.cuts.is_cut(segment), expected.contains(segment));
    ASSERT_EQ(body.cuts.find(segment) != nullptr, expected.contains(segment));
    if (!expected.contains(segment))
      continue;
    const SkinCut &found = *body.cuts.find(segment), &added = expected[segment];
    EXPECT_EQ(&found, &body.cuts.skin_cuts()[body.cuts.index(segment)]);
    EXPECT_EQ(found.segment, segment);
    EXPECT_EQ(found.t, std::clamp(added.t, min_edge_parameter, 1 - min_edge_parameter));
    EXPECT_EQ(found.normal, added.normal);
    EXPECT_THROW(body.cuts.add(a_cut(segment, 0.5, 2)), std::logic_error);
    EXPECT_EQ(body.cuts.skin_cuts().size(), expected.size()) << "refused, and left alone";
  }
}

/// The cells on both sides of a face have its halves in common, and no two segments of a cell are one.
TEST(Cuts, OfTheSkinAreSharedAcrossFaces) {
  const Body body = support::block({2, 1, 1});
  std::map<SkinSegment, int> n_cells;
  for (const auto c : ids<CellId>(body.grid.n_cells()))
    for (Segments left = skeleton_of(material_of(body.grid, c)).segments & ~skeleton::lines; left != 0;
         left &= left - 1)
      ++n_cells[skin_segment(body.grid, c, std::countr_zero(left))];
  for (const auto& [segment, n] : n_cells)
    EXPECT_EQ(n, segment.face.valid() ? 2 : 1);
  EXPECT_EQ(n_cells.size(), 2u * 20 + 8 * 6 + 4 * 8) << "20 arcs; cells with 3 and with 4 lines of the skin";
}

TEST(Cuts, OfTheSkinAreTakenBackUntilTheyAreSettled) {
  Random random(13);
  for (int i = 0; i < 50; ++i) {
    Body body = support::block({2, 2, 2});
    std::map<SkinSegment, double> expected;
    std::vector<SkinSegment> order;
    const auto add = [&](const double probability) {
      for (const SkinCut& cut : histories::random_skin_cuts(random, body, probability)) {
        body.cuts.add(cut);
        expected[cut.segment] = body.cuts.find(cut.segment)->t;
        order.push_back(cut.segment);
      }
    };
    add(0.3);
    body.cuts.settle();
    const std::size_t n_settled = expected.size();
    add(0.4);
    std::set<SkinSegment> taken; // some that are settled among them, and some that are not cut
    for (const SkinSegment& segment : histories::skin_segments(body.grid))
      if (random() % 3 == 0)
        taken.insert(segment);
    body.cuts.leave_whole(std::vector<SkinSegment>(taken.begin(), taken.end()));
    std::set<SkinSegment> left;
    for (std::size_t k = n_settled; k < order.size(); ++k)
      if (taken.contains(order[k]))
        left.insert(order[k]);
    ASSERT_EQ(body.cuts.n_left_whole(), left.size());
    for (const SkinSegment& segment : left) {
      EXPECT_EQ(body.cuts.later_cuts(segment).size(), 1u);
      EXPECT_EQ(body.cuts.segments_left_whole().at(segment).t, expected[segment]);
    }
    for (std::size_t k = order.size(); k-- > n_settled;)
      if (taken.contains(order[k])) {
        expected.erase(order[k]);
        order.erase(order.begin() + static_cast<long>(k));
      }
    ASSERT_EQ(body.cuts.skin_cuts().size(), order.size());
    for (std::size_t k = 0; k < order.size(); ++k) {
      ASSERT_EQ(body.cuts.skin_cuts()[k].segment, order[k]);
      ASSERT_EQ(body.cuts.index(order[k]), k);
      ASSERT_EQ(body.cuts.find(order[k])->t, expected[order[k]]);
      ASSERT_EQ(body.cuts.is_new(order[k]), k >= n_settled);
    }
    ASSERT_EQ(body.cuts.new_skin_cuts().size(), order.size() - n_settled);
    for (const SkinSegment& segment : histories::skin_segments(body.grid)) {
      ASSERT_EQ(body.cuts.is_cut(segment), expected.contains(segment));
      if (!expected.contains(segment)) {
        ASSERT_FALSE(body.cuts.is_new(segment));
        body.cuts.add(a_cut(segment, 0.5, 2)); // it may be cut again
        ASSERT_EQ(body.cuts.find(segment)->label, 2);
        ASSERT_TRUE(body.cuts.is_new(segment));
      }
    }
    EXPECT_TRUE(body.cuts.segments_left_whole().empty());
  }
}

TEST(Cuts, AreNewUntilTheyAreSettled) {
  Random random(14);
  Body body = support::block({3, 2, 2});
  EXPECT_EQ(body.cuts.new_cuts().size(), body.cuts.all().size()) << "the skin itself";
  std::size_t n = 0, n_of_skin = 0;
  for (int round = 0; round < 4; ++round) {
    body.cuts.settle();
    EXPECT_TRUE(body.cuts.new_cuts().empty() && body.cuts.new_skin_cuts().empty());
    n = body.cuts.all().size();
    n_of_skin = body.cuts.skin_cuts().size();
    const auto plan = histories::random_plan(random, body, 0.3, 0.3, 0.3);
    histories::apply(plan, body);
    EXPECT_EQ(body.cuts.new_cuts().size(), plan.cuts.size());
    EXPECT_EQ(body.cuts.new_skin_cuts().size(), plan.of_skin.size());
    for (const auto e : ids<EdgeId>(body.grid.n_edges()))
      EXPECT_EQ(body.cuts.is_new(e), body.cuts.is_cut(e) && body.cuts.index(e) >= n);
    for (const SkinSegment& segment : histories::skin_segments(body.grid))
      EXPECT_EQ(body.cuts.is_new(segment), body.cuts.is_cut(segment) && body.cuts.index(segment) >= n_of_skin);
  }
}

TEST(Cuts, StayInsideTheirEdge) {
  Body body = support::block({3, 2, 2});
  for (const double t : {-1.0, 0.0, 1e-300, 1.0, 7.0}) {
    Cuts cuts(body.grid);
    const EdgeId e = *body.grid.find_edge({1, 1, 1}, 0);
    cuts.add(body.grid, {e, t, Vec3::UnitX(), 1});
    EXPECT_GE(cuts.find(e)->t, min_edge_parameter);
    EXPECT_LE(cuts.find(e)->t, 1 - min_edge_parameter);
  }
}

TEST(Cuts, GiveTheLineBitsOfACell) {
  Random random(2);
  Body body = support::block({3, 3, 3});
  for (const auto& cut : support::random_cuts(random, body, 0.4))
    body.cuts.add(body.grid, cut);
  for (const auto c : ids<CellId>(body.grid.n_cells()))
    for (int line = 0; line < 12; ++line)
      EXPECT_EQ((body.cuts.configuration(body.grid, c) >> line & 1) == 1, body.cuts.is_cut(body.grid.edges(c)[line]));
}

TEST(Cuts, KeepThePointsOfFacesAndCells) {
  Body body = support::block({2, 2, 2}, 0.5);
  const CellId c = *body.grid.find_cell({1, 1, 1});
  for (int face = 0; face < 6; ++face) {
    Vec3 middle = Vec3::Constant(0.75);
    middle[face / 2] = face & 1 ? 1 : 0.5;
    const FaceId f = body.grid.faces(c)[face];
    EXPECT_EQ(centre(body.grid, f), middle);
    EXPECT_EQ(body.cuts.point(f), nullptr);
    EXPECT_EQ(face_point(body, f), middle);
    body.cuts.set_point(f, middle + Vec3::Constant(face));
    body.cuts.set_point(f, middle - Vec3::Constant(face));
    EXPECT_EQ(face_point(body, f), middle - Vec3::Constant(face));
  }
  EXPECT_EQ(centre(body.grid, c), Vec3(0.75, 0.75, 0.75));
  EXPECT_EQ(cell_point(body, c), Vec3(0.75, 0.75, 0.75));
  body.cuts.set_point(c, {0.6, 0.7, 0.8});
  EXPECT_EQ(cell_point(body, c), Vec3(0.6, 0.7, 0.8));
}

TEST(Cuts, KeepInnerPointsApart) {
  Body body = support::block({1, 1, 1});
  std::map<const Vec3*, Vec3> expected;
  std::size_t n = 0;
  const auto next = [&] { return Vec3(static_cast<double>(++n), 2, 3); };
  for (const int round : {1, 2}) { // set, and set anew
    for (const auto f : ids<FaceId>(body.grid.n_faces()))
      for (const int arc : {0, 1}) {
        EXPECT_EQ(body.cuts.inner_point(f, arc) == nullptr, round == 1);
        body.cuts.set_inner_point(f, arc, next());
      }
    for (const auto c : ids<CellId>(body.grid.n_cells())) {
      EXPECT_EQ(body.cuts.inner_point(c) == nullptr, round == 1);
      body.cuts.set_inner_point(c, next());
      for (int triangle = 0; triangle < skeleton::n_sides - skeleton::first_triangle; ++triangle) {
        EXPECT_EQ(body.cuts.inner_point(c, triangle) == nullptr, round == 1);
        body.cuts.set_inner_point(c, triangle, next());
      }
    }
  }
  n /= 2;
  for (const auto f : ids<FaceId>(body.grid.n_faces())) {
    EXPECT_EQ(body.cuts.point(f), nullptr);
    for (const int arc : {0, 1})
      EXPECT_EQ(*body.cuts.inner_point(f, arc), next());
  }
  for (const auto c : ids<CellId>(body.grid.n_cells())) {
    EXPECT_EQ(body.cuts.point(c), nullptr);
    EXPECT_EQ(*body.cuts.inner_point(c), next());
    for (int triangle = 0; triangle < skeleton::n_sides - skeleton::first_triangle; ++triangle)
      EXPECT_EQ(*body.cuts.inner_point(c, triangle), next());
  }
  for (const SkinSegment& segment : histories::skin_segments(body.grid))
    EXPECT_FALSE(body.cuts.is_cut(segment));
}

/// Where an item is, by what it is named.
Vec3 named_point(const Body& body, const CellId c, const int item) {
  const slow::Point& at = slow::named(material_of(body.grid, c), item, slow::lattice_cell(body.grid, c)).at;
  Vec3 p = body.grid.position(*body.grid.find_node({at[0] / 2, at[1] / 2, at[2] / 2})); // the lower end
  if (slow::n_odd(at) == 1) {
    const int axis = slow::axis_of(at);
    for (const EdgeCut& cut : body.cuts.all()) // the skin's alone
      if (cut.label == skin_label && cut.edge == *body.grid.find_edge({at[0] / 2, at[1] / 2, at[2] / 2}, axis))
        p[axis] += body.grid.h() * cut.t;
  } else if (slow::n_odd(at) == 2)
    p = *body.cuts.point(body.grid.faces(c)[(item - skeleton::first_on_arc) / 2]);
  else if (slow::n_odd(at) == 3)
    p = *body.cuts.point(c);
  return p;
}

TEST(Cuts, SayWhereItemsAndSegmentsAre) {
  Random random(15);
  auto nodes = support::some_nodes(random, {3, 2, 2}, 0.6);
  nodes.push_back({2, 2, 2});
  Body body = support::make_body({{1, 2, 3}, 0.5}, nodes, [&](const Grid& grid, const EdgeId e) {
    EdgeCut cut = support::midway(grid, e);
    cut.t = uniform(random, 0.1, 0.9);
    return cut;
  });
  for (const auto f : ids<FaceId>(body.grid.n_faces()))
    body.cuts.set_point(f, support::random_vector(random));
  for (const auto c : ids<CellId>(body.grid.n_cells()))
    body.cuts.set_point(c, support::random_vector(random));
  const auto plan = histories::random_plan(random, body, 0.4, 0.5, 0.5);
  histories::apply(plan, body);
  std::array<std::size_t, 4> n{}; // lines and others, uncut and cut
  for (const auto c : ids<CellId>(body.grid.n_cells())) {
    const Skeleton& skeleton = skeleton_of(material_of(body.grid, c));
    for (int item = 0; item < skeleton::n_items; ++item)
      if (skeleton.items >> item & 1) {
        ASSERT_LT((item_point(body, c, item) - named_point(body, c, item)).norm(), 1e-15);
      }
    for (int s = 0; s < skeleton::n_segments; ++s) {
      if (!(skeleton.segments >> s & 1))
        continue;
      const Vec3 p = named_point(body, c, skeleton.segment[s].ends[0]);
      const Vec3 q = named_point(body, c, skeleton.segment[s].ends[1]);
      Vec3 expected = 0.5 * (p + q);
      bool is_cut = false;
      for (const EdgeCut& cut : plan.cuts)
        if (s < 12 && cut.edge == body.grid.edges(c)[s]) {
          is_cut = true;
          expected = body.grid.position(body.grid.ends(cut.edge)[0]);
          expected[cube::line_axis(s)] += body.grid.h() * body.cuts.find(cut.edge)->t;
        }
      for (const SkinCut& cut : plan.of_skin)
        if (s >= 12 && cut.segment == skin_segment(body.grid, c, s)) {
          is_cut = true;
          expected = p + body.cuts.find(cut.segment)->t * (q - p);
        }
      ASSERT_LT((segment_point(body, c, skeleton, s) - expected).norm(), 1e-14);
      ++n[2 * (s >= 12) + is_cut];
    }
  }
  for (const std::size_t k : n)
    EXPECT_GT(k, 20u);
}

} // namespace
} // namespace kerf::grid::cuts_test
