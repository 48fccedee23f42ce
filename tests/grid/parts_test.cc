/// The parts of cells, and the arcs of the skin, against slow_parts.h.

#include "grid/parts.h"

#include "tests/grid/histories.h"
#include "tests/grid/symmetries.h"

#include <gtest/gtest.h>

#include <bit>
#include <set>

namespace kerf::grid::parts_test {
namespace {

using slow::Items;
using slow::Point;
using support::Body;
using support::Random;
using support::uniform;

/// How likely blades cut: lines between nodes, lines of the skin, halves of arcs, spokes.
using Probabilities = std::array<double, 4>;

int kind_of(const Skeleton& skeleton, const int segment) {
  if (segment < skeleton::first_half)
    return skeleton.segment[segment].ends[1] < skeleton::first_on_line ? 0 : 1;
  return segment < skeleton::first_spoke ? 2 : 3;
}

CellCuts random_cell(Random& random, const unsigned material, const Probabilities& probabilities) {
  CellCuts cell{material, 0, 0};
  const Skeleton& skeleton = cell.skeleton();
  for (int s = 0; s < skeleton::n_segments; ++s) {
    if (!(skeleton.segments >> s & 1))
      continue;
    const int kind = kind_of(skeleton, s);
    const bool by_blade = uniform(random, 0, 1) < probabilities[kind];
    cell.blades |= Segments(by_blade) << s;
    if (s < skeleton::first_half)
      cell.cut |= unsigned(by_blade || kind == 1) << s;
  }
  return cell;
}

/// Each set of material vertices, so many times; often none of some kind is cut, or all.
template <class Check>
void for_random_cells(const unsigned seed, const int n_each, const Check& check) {
  Random random(seed);
  for (unsigned material = 0; material < 256; ++material)
    for (int i = 0; i < n_each; ++i) {
      Probabilities probabilities;
      for (double& p : probabilities)
        p = random() % 4 == 0 ? 0 : random() % 4 == 0 ? 1 : uniform(random, 0, 1);
      check(random_cell(random, material, probabilities));
      ASSERT_FALSE(testing::Test::HasFatalFailure()) << "material " << material << ", " << i;
    }
}

std::set<Items> as_sets(const unsigned material, const Parts& parts, const Index3& cell = {}) {
  std::set<Items> sets;
  for (const Part& part : parts)
    sets.insert(slow::named(material, part, cell));
  return sets;
}

std::set<Items> as_sets(const std::vector<Items>& parts) { return {parts.begin(), parts.end()}; }

/// The order that is promised.
void expect_ordered(const Parts& parts) {
  for (const Part& part : parts)
    ASSERT_NE(part.items(), 0u);
  for (int i = 1; i < parts.n; ++i)
    ASSERT_LT(std::countr_zero(parts.items[i - 1].items()), std::countr_zero(parts.items[i].items()));
}

TEST(SkinArcs, AreThoseOfAWalkRoundTheFace) {
  std::size_t n_arcs = 0, n_with_two = 0;
  for (int face = 0; face < 6; ++face)
    for (unsigned pattern = 0; pattern < 16; ++pattern) {
      CellCuts cell;
      for (int i = 0; i < 4; ++i)
        cell.material |= (pattern >> i & 1) << cube::face_vertices[face][i];
      using Ends = std::set<std::pair<Point, Point>>; // edge and node, at either end
      std::set<std::pair<Ends, std::set<Point>>> arcs, walked;
      for (const SkinArc& arc : skin_arcs(face, cell.material)) {
        Ends ends;
        std::set<Point> inner;
        for (int end = 0; end < 2; ++end)
          ends.emplace(slow::line_point({}, arc.lines[end]), slow::node_point({}, arc.vertices[end]));
        for (int line = 0; line < 12; ++line)
          if (arc.inner >> line & 1)
            inner.insert(slow::line_point({}, line));
        arcs.emplace(ends, inner);
      }
      for (const slow::Arc& arc : slow::arcs(slow::material_of(cell), slow::face_centre({}, face)))
        walked.emplace(Ends{{arc.edges[0], arc.nodes.front()}, {arc.edges[1], arc.nodes.back()}},
                       std::set<Point>(arc.inner.begin(), arc.inner.end()));
      EXPECT_EQ(arcs, walked) << "face " << face << ", pattern " << pattern;
      EXPECT_EQ(arcs.size(), skin_arcs_of_face[face][pattern].n);
      n_arcs += arcs.size();
      n_with_two += arcs.size() == 2;
    }
  EXPECT_EQ(n_arcs, 6u * (12 + 2 * 2)) << "two for opposite vertices, none without or with all four, else one";
  EXPECT_EQ(n_with_two, 6u * 2);
}

TEST(Parts, OfACellAreThoseOfAFlood) {
  int most = 0;
  std::size_t n_without_nodes = 0, n_held_by_skin = 0, n_unsaid = 0;
  for_random_cells(1, 80, [&](const CellCuts& cell) {
    const slow::Material material = slow::material_of(cell);
    const Parts parts = parts_of(cell), whole = whole_parts_of(cell);
    ASSERT_EQ(as_sets(cell.material, parts), slow::said_parts(material, {1, 1, 1}));
    ASSERT_EQ(as_sets(cell.material, whole), as_sets(slow::parts(material, slow::closure({1, 1, 1}))));
    expect_ordered(parts);
    expect_ordered(whole);
    most = std::max(most, parts.n);
    n_without_nodes += parts.n > 0 && parts.items[parts.n - 1].nodes == 0;
    n_unsaid += parts.n > 0 && cell.has_skin() && parts.items[0].skin == 0;
    n_held_by_skin += std::any_of(parts.begin(), parts.end(), [&](const Part& part) {
      return part.nodes != 0 && part.nodes != (cube::reachable(std::countr_zero(part.nodes), cell.cut));
    });
  });
  EXPECT_GE(most, 25);
  EXPECT_GT(n_without_nodes, 8000u);
  EXPECT_GT(n_held_by_skin, 1000u) << "nodes that only the skin holds together";
  EXPECT_GT(n_unsaid, 100u) << "skins that no blade has cut";
}

TEST(Parts, SayWhereBladesHaveCutAtTheSkin) {
  std::size_t n_cut = 0, n_uncut = 0;
  for_random_cells(4, 20, [&](const CellCuts& cell) {
    const bool is_cut = slow::is_cut_at_skin(slow::material_of(cell), {1, 1, 1});
    ASSERT_EQ(cell.is_cut_at_skin(), is_cut);
    ASSERT_EQ(cell.has_skin(), cell.material != 0xff);
    for (const Part& part : parts_of(cell))
      ASSERT_TRUE(is_cut || part.skin == 0);
    n_cut += is_cut;
    n_uncut += !is_cut;
  });
  EXPECT_GT(n_cut, 1000u);
  EXPECT_GT(n_uncut, 30u);
}

/// All segments cut leave each item alone; none, what the edges between nodes join, skin and all.
TEST(Parts, AreItemsAtMostAndBodiesAtLeast) {
  int most = 0;
  for (unsigned material = 0; material < 256; ++material) {
    const Skeleton& skeleton = skeleton_of(material);
    const auto cut_lines = static_cast<unsigned>(skeleton.segments & skeleton::lines);
    const Parts all = whole_parts_of({material, cut_lines, skeleton.segments});
    ASSERT_EQ(all.n, std::popcount(skeleton.items));
    most = std::max(most, all.n);
    Items items;
    const Parts none = whole_parts_of({material, 0, 0});
    for (const Part& part : none) {
      const int first = std::countr_zero(part.nodes);
      ASSERT_EQ(part.nodes, cube::reachable(first, 0, material));
      for (const slow::Item& item : slow::named(material, part))
        ASSERT_TRUE(items.insert(item).second);
    }
    ASSERT_EQ(items.size(), static_cast<std::size_t>(std::popcount(skeleton.items)));
  }
  EXPECT_EQ(most, 32) << "four nodes, no two of them side by side, with seven points of the skin each";
}

TEST(Parts, AreWhatIsReachable) {
  for_random_cells(8, 4, [](const CellCuts& cell) {
    const Skeleton& skeleton = cell.skeleton();
    for (const Part& part : whole_parts_of(cell))
      for (grid::Items left = part.items(); left != 0; left &= left - 1)
        ASSERT_EQ(skeleton.reachable(left & -left, cell.blades), part.items());
    grid::Items two = 0; // from items of several parts
    for (const Part& part : whole_parts_of(cell))
      two |= std::countr_zero(part.items()) % 2 == 0 ? part.items() : 0;
    grid::Items from = 0;
    for (grid::Items left = two; left != 0; left &= left - 1)
      if (std::popcount(left) % 3 == 0)
        from |= left & -left;
    grid::Items expected = 0;
    for (const Part& part : whole_parts_of(cell))
      expected |= (part.items() & from) != 0 ? part.items() : 0;
    ASSERT_EQ(skeleton.reachable(from, cell.blades), expected);
  });
}

/// The same cell turned: its segments by the ends that they join.
CellCuts image_of(const CellCuts& cell, const slow::Symmetry& symmetry) {
  CellCuts image{symmetry.vertices(cell.material), symmetry.lines(cell.cut), 0};
  std::map<slow::Segment, int> number;
  for (int s = 0; s < skeleton::n_segments; ++s)
    if (image.skeleton().segments >> s & 1)
      number[slow::named_segment(image.material, s)] = s;
  for (int s = 0; s < skeleton::n_segments; ++s)
    if (cell.blades >> s & 1)
      image.blades |= Segments(1) << number.at(symmetry(slow::named_segment(cell.material, s)));
  return image;
}

TEST(Parts, TurnWithTheCube) {
  for (const slow::Symmetry& symmetry : slow::symmetries())
    for_random_cells(5, 1, [&](const CellCuts& cell) {
      const CellCuts image = image_of(cell, symmetry);
      std::set<Items> turned;
      for (const Items& part : as_sets(cell.material, parts_of(cell)))
        turned.insert(symmetry(part));
      ASSERT_EQ(as_sets(image.material, parts_of(image)), turned);
    });
}

struct Glued {
  std::size_t n_pairs = 0, n_glued = 0, n_by_skin = 0;
};

/// Glued is who has an item in common, whether it is said or not.
void expect_glued(const slow::Material& material, const Body& body, const CellId below, const int axis, Glued& glued) {
  const CellId above = body.grid.neighbour(below, 2 * axis + 1);
  if (!above.valid())
    return;
  const auto whole = [&](const Items& items, const CellId c) {
    for (const Items& all : slow::parts(material, slow::closure(slow::cell_centre(slow::lattice_cell(body.grid, c)))))
      if (all.contains(*items.begin()))
        return all;
    return Items();
  };
  for (const Part& a : parts_of(cuts_of(body, below)))
    for (const Part& b : parts_of(cuts_of(body, above))) {
      const Items p = whole(slow::named(material_of(body.grid, below), a, slow::lattice_cell(body.grid, below)), below);
      const Items q = whole(slow::named(material_of(body.grid, above), b, slow::lattice_cell(body.grid, above)), above);
      const auto is_common = [&](const slow::Item& item) { return q.contains(item); };
      const bool is_glued = std::ranges::any_of(p, is_common);
      ASSERT_EQ(are_glued(a, b, axis), is_glued);
      ++glued.n_pairs;
      glued.n_glued += is_glued;
      glued.n_by_skin += is_glued && std::ranges::none_of(slow::nodes_of(p), is_common);
    }
}

TEST(Parts, AreThoseOfAllWhoShareThem) {
  Random random(6);
  Glued glued;
  for (int i = 0; i < 60; ++i) {
    auto nodes = support::some_nodes(random, {3, 3, 2}, uniform(random, 0.2, 1));
    nodes.push_back({2, 2, 2});
    const Body blank = support::make_body({}, nodes, support::midway);
    const auto some = [&](const double most) { return random() % 4 == 0 ? 0 : uniform(random, 0, most); };
    const Body body = histories::applied(
      histories::random_plan(random, blank, some(0.8), some(1), random() % 3 == 0 ? 0.01 : some(0.8)), blank);
    const slow::Material material = slow::material_of(body);
    for (const auto c : ids<CellId>(body.grid.n_cells())) {
      const Index3 cell = slow::lattice_cell(body.grid, c);
      ASSERT_EQ(as_sets(material_of(body.grid, c), parts_of(cuts_of(body, c)), cell),
                slow::said_parts(material, slow::cell_centre(cell)));
      for (int axis = 0; axis < 3; ++axis)
        expect_glued(material, body, c, axis, glued);
      ASSERT_FALSE(HasFatalFailure()) << "random body " << i;
    }
  }
  EXPECT_GT(glued.n_pairs, 25000u);
  EXPECT_GT(glued.n_glued, 5000u);
  EXPECT_GT(glued.n_by_skin, 1000u);
}

/// A part that has an interval may be in another group too: what they make has it, whichever part comes first.
TEST(Parts, OfTwoGroupsKeepTheirIntervals) {
  constexpr unsigned all_lines = 0xfff; // cut: each node by itself
  for (const int with_interval : {0, 7}) {
    const std::vector<Joined> groups = {{grid::Items(1) << with_interval, 2}, {grid::Items(0x81), 0}};
    const Parts parts = parts_of({0xff, all_lines, all_lines, &groups});
    ASSERT_EQ(parts.n, 7);
    EXPECT_EQ(parts.items[0], (Part{0x81, 0, 2})) << with_interval;
  }
}

} // namespace
} // namespace kerf::grid::parts_test
