// Crumbs: which pieces they are, found from scratch and cut by cut.

#include "grid/crumbs.h"

#include "grid/material.h"
#include "tests/grid/histories.h"
#include "tests/support/placed.h"
#include "tests/support/same.h"
#include "tests/support/whole_crumbs.h"

#include <gtest/gtest.h>

#include <bit>
#include <map>
#include <set>

namespace kerf::grid::crumbs_test {
namespace {

using support::Body;

/// Whether a piece is one, by its definition; the slow way.
std::vector<bool> are_crumbs(const Body& body, const bool is_cut) {
  const Pieces pieces = grid::pieces(body.complex);
  std::vector<bool> loose(pieces.n_pieces, true);
  std::vector<std::set<std::array<int, 3>>> nodes(pieces.n_pieces);
  for (const auto c : ids<CopyId>(body.complex.n_copies())) {
    const Copy& copy = body.complex.copies[c];
    if (std::popcount(copy.nodes) > 1 && fill(body, copy) >= well_filled)
      loose[pieces.piece[c]] = false;
    for (int v = 0; v < 8; ++v)
      if (copy.nodes >> v & 1)
        nodes[pieces.piece[c]].insert(body.grid.index(body.grid.nodes(copy.cell)[v]));
  }
  std::vector<bool> crumbs;
  for (std::size_t p = 0; p < loose.size(); ++p) {
    bool is_small = is_cut;
    for (const auto& a : nodes[p])
      for (const auto& b : nodes[p])
        for (int axis = 0; axis < 3; ++axis)
          is_small = is_small && std::abs(a[axis] - b[axis]) <= 1;
    crumbs.push_back(loose[p] || is_small);
  }
  return crumbs;
}

void expect_crumbs_are_those_pieces(const Body& body, const std::vector<bool>& expected) {
  const Pieces pieces = grid::pieces(body.complex);
  std::set<CopyId> seen;
  for (std::size_t i = 0; i < body.crumbs.all.size(); ++i) {
    const Crumb& crumb = body.crumbs.all[i];
    if (i > 0) {
      EXPECT_LT(body.crumbs.all[i - 1].name, crumb.name);
    }
    for (const CopyId c : crumb.copies) {
      EXPECT_EQ(pieces.piece[c], pieces.piece[crumb.copies[0]]);
      EXPECT_TRUE(seen.insert(c).second) << "in two crumbs";
    }
  }
  for (const auto c : ids<CopyId>(body.complex.n_copies())) {
    if (body.complex.copies[c].is_lapsed()) {
      EXPECT_FALSE(seen.contains(c));
      EXPECT_TRUE(body.crumbs.holds(c));
      continue;
    }
    EXPECT_EQ(seen.contains(c), expected[pieces.piece[c]]) << c.value;
    EXPECT_EQ(body.crumbs.holds(c), seen.contains(c));
    for (const CornerId corner : body.complex.copies[c].corners)
      EXPECT_EQ(body.crumbs.holds(corner), seen.contains(c));
  }
}

/// A whole body of a few nodes is none: nothing has cut it. One node alone is.
TEST(Crumbs, OfWholeBodiesOnlyLoosePieces) {
  for (const auto& [n, is_crumb] :
       {std::pair{Index3{2, 2, 2}, false}, {Index3{1, 1, 1}, true}, {Index3{5, 5, 1}, false}}) {
    Body body = support::with_copies(support::with_placed_skin(support::block(n)));
    find_crumbs(body);
    EXPECT_EQ(body.crumbs.any(), is_crumb) << n[0] << n[1] << n[2];
    expect_crumbs_are_those_pieces(body, are_crumbs(body, false));
  }
}

/// Random cuts, batch by batch, down to dust. Copies of skin alone are among them.
TEST(Crumbs, AfterCutsAreThePiecesThatTheDefinitionNames) {
  std::size_t n_crumbs = 0, n_left = 0;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    support::Random random(seed);
    Body body = support::with_copies(support::with_placed_skin(
      seed % 2 == 0 ? support::block({5, 4, 4}, 0.1) : support::ball(0.3, 0.1, support::random_offset(random))));
    find_crumbs(body);
    cut::Cutter cutter{9};
    const Points x = rest_positions(body);
    cutter.begin(body, x);
    for (int batch = 0; batch < 8; ++batch) {
      std::set<CopyId> before;
      for (const Crumb& crumb : body.crumbs.all)
        before.insert(crumb.copies.begin(), crumb.copies.end());
      const histories::Plan plan = histories::random_plan(random, body, 0.2, 0.2, 0.2);
      CutChange change = cutter.cut(body, {plan.cuts, plan.of_skin, 0});
      surface::place(body, change, {});
      update_crumbs(body, change);
      EXPECT_TRUE(std::is_sorted(change.reshaped.begin(), change.reshaped.end()));
      for (const Crumb& crumb : body.crumbs.all)
        for (const CopyId c : crumb.copies)
          EXPECT_TRUE(before.contains(c) || std::binary_search(change.reshaped.begin(), change.reshaped.end(), c))
            << "what follows the change hears of each new one";
      auto expected = are_crumbs(body, true);
      const Pieces pieces = grid::pieces(body.complex);
      for (const CopyId c : before) // what a cut leaves of a crumb stays one
        expected[pieces.piece[c]] = true;
      expect_crumbs_are_those_pieces(body, expected);
    }
    n_crumbs += body.crumbs.all.size();
    n_left += n_pieces(body.complex) - body.crumbs.all.size();
  }
  EXPECT_GT(n_crumbs, 200u);
  EXPECT_GT(n_left, 0u);
}

/// A node of which a cut is still to come through all edges hangs by ties, and is a crumb when it has come.
TEST(Crumbs, HangByNoTies) {
  Body body = support::with_copies(support::with_placed_skin(support::block({6, 6, 6}, 0.1)));
  find_crumbs(body);
  NodeId node;
  for (const auto n : ids<NodeId>(body.grid.n_nodes()))
    if (body.grid.index(n) == Index3{3, 3, 3})
      node = n;
  std::vector<CellId> cells;
  std::set<EdgeId> edges;
  for (const auto c : ids<CellId>(body.grid.n_cells())) {
    const auto nodes = body.grid.nodes(c);
    Front front{.cell = c, .passed = 0.5};
    for (int line = 0; line < cube::n_lines; ++line)
      for (const int v : cube::line_vertices[line])
        if (nodes[v] == node) {
          front.ahead |= Segments(1) << line;
          edges.insert(body.grid.edges(c)[line]);
        }
    if (front.ahead != 0) {
      body.cuts.set(front);
      cells.push_back(c);
    }
  }
  CutChange change = update_complex(body, {}, {}, cells);
  update_crumbs(body, change);
  EXPECT_EQ(body.complex.tied.size(), 8u);
  EXPECT_EQ(n_pieces(body.complex), 1u);
  EXPECT_FALSE(body.crumbs.any());
  std::vector<EdgeCut> cuts;
  for (const EdgeId e : edges) // what one blade alone cuts out is a shaving, and stays
    cuts.push_back({e, 0.5, Vec3::UnitX(), static_cast<CutLabel>(cuts.size() + 1)});
  cut::Cutter cutter{6};
  cutter.begin(body, rest_positions(body));
  change = cutter.cut(body, {cuts, {}, 0});
  surface::place(body, change, {});
  update_crumbs(body, change);
  EXPECT_TRUE(body.complex.tied.empty());
  EXPECT_EQ(n_pieces(body.complex), 2u);
  EXPECT_EQ(body.crumbs.all.size(), 1u);
}

/// A crumb that a cut does not meet keeps its name.
TEST(Crumbs, KeepTheirNamesUntilTheyAreCut) {
  Body body = support::with_copies(support::with_placed_skin(support::block({6, 6, 6}, 0.1)));
  find_crumbs(body);
  cut::Cutter cutter{9};
  const Points x = rest_positions(body);
  cutter.begin(body, x);
  std::set<std::uint32_t> names;
  CutLabel label = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (const double at : {0.2, 0.4, 0.6}) {
      CutChange change = cutter.cut(body, support::cuts_of_plane(body, {Vec3::Unit(axis), at}, ++label));
      surface::place(body, change, {});
      std::set<std::uint32_t> met;
      for (const Crumb& crumb : body.crumbs.all)
        for (const CopyId c : crumb.copies)
          if (std::binary_search(change.reshaped.begin(), change.reshaped.end(), c))
            met.insert(crumb.name);
      update_crumbs(body, change);
      for (const auto name : names)
        EXPECT_EQ(met.contains(name), std::none_of(body.crumbs.all.begin(), body.crumbs.all.end(),
                                                   [&](const Crumb& c) { return c.name == name; }));
      names.clear();
      for (const Crumb& crumb : body.crumbs.all)
        names.insert(crumb.name);
    }
  EXPECT_EQ(names.size(), n_pieces(body.complex)) << "all is dust in the end";
}

/// These of a cell hang together from now on, with all that hung on one of them before.
CutChange join(Body& body, const CellId cell, const Joined& group) {
  std::vector<Joined> groups = {group};
  if (const auto* const earlier = body.cuts.joined(cell))
    for (const Joined& other : *earlier) {
      if ((other.items & group.items) == 0) {
        groups.push_back(other);
        continue;
      }
      groups[0].items |= other.items;
      groups[0].intervals |= other.intervals;
    }
  body.cuts.set_joined(cell, groups);
  return update_complex(body, {}, {}, std::array{cell});
}

/// All items of two copies of a cell.
CutChange join(Body& body, const CopyId a, const CopyId b) {
  const Copy &of_a = body.complex.copies[a], &of_b = body.complex.copies[b];
  return join(body, of_a.cell, {of_a.items() | of_b.items(), 0});
}

/// A copy and what lies between two cuts on a line of a face.
CutChange join_interval(Body& body, const CopyId c, const int face) {
  const Intervals of_line = skeleton::intervals_of(skeleton::in_face(face, 0));
  return join(body, body.complex.copies[c].cell, {body.complex.copies[c].items(), of_line & -of_line});
}

/// Cuts make crumbs, and joins take them back: what comes from one crumb alone stays one, all else is what the
/// definition names. Who follows hears of each copy that was in a crumb, or is now.
TEST(Crumbs, BecomeMaterialAgainWhereTheyAreJoined) {
  std::size_t n_ended = 0, n_of_two = 0, n_stay = 0;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    support::Random random(200 + seed);
    Body body = support::with_copies(support::with_placed_skin(
      seed % 2 == 0 ? support::block({5, 4, 4}, 0.1) : support::ball(0.3, 0.1, support::random_offset(random))));
    find_crumbs(body);
    cut::Cutter cutter{9};
    cutter.begin(body, rest_positions(body));
    for (int batch = 0; batch < 5; ++batch) {
      const histories::Plan plan = histories::random_plan(random, body, 0.4, 0.2, 0.2);
      CutChange change = cutter.cut(body, {plan.cuts, plan.of_skin, 0});
      surface::place(body, change, {});
      update_crumbs(body, change);
    }
    for (int k = 0; k < 150; ++k) {
      const CopyId a(support::uniform(random, 0, 1) * double(body.complex.n_copies()));
      const CopyId b = body.complex.copies[a].next;
      if (!b.valid())
        continue;
      std::map<std::pair<CellId, int>, std::uint32_t> crumb_of; // of items
      std::set<CopyId> held;
      const auto for_each_item = [&](const CopyId c, const auto& f) {
        for (Items left = body.complex.copies[c].items(); left != 0; left &= left - 1)
          f(std::pair(body.complex.copies[c].cell, std::countr_zero(left)));
      };
      for (const auto c : ids<CopyId>(body.complex.n_copies())) {
        for_each_item(c, [&](const auto& item) { crumb_of[item] = body.crumbs.of(c); });
        if (body.crumbs.holds(c))
          held.insert(c);
      }
      CutChange change = join(body, a, b);
      surface::place(body, change, {});
      update_crumbs(body, change);
      EXPECT_TRUE(std::is_sorted(change.reshaped.begin(), change.reshaped.end()));
      if (k % 15 == 0) {
        EXPECT_TRUE(support::renaming(body.complex, build_complex(body)).has_value());
      }
      const Pieces pieces = grid::pieces(body.complex);
      std::vector<std::set<std::uint32_t>> from(pieces.n_pieces);
      for (const auto c : ids<CopyId>(body.complex.n_copies())) {
        for_each_item(c, [&](const auto& item) { from[pieces.piece[c]].insert(crumb_of.at(item)); });
        EXPECT_TRUE(body.crumbs.holds(c) == held.contains(c) || std::ranges::binary_search(change.reshaped, c));
      }
      auto expected = are_crumbs(body, true);
      for (std::size_t p = 0; p < from.size(); ++p) {
        const bool is_of_one = from[p].size() == 1 && !from[p].contains(Crumbs::none);
        expected[p] = expected[p] || is_of_one;
        n_stay += is_of_one;
        n_ended += from[p].size() > 1 && !expected[p];
        n_of_two += from[p].size() > 1 && !from[p].contains(Crumbs::none);
      }
      expect_crumbs_are_those_pieces(body, expected);
    }
  }
  EXPECT_GT(n_ended, 20u);
  EXPECT_GT(n_of_two, 5u);
  EXPECT_GT(n_stay, 50u);
}

/// An interval on a face joins a crumb to what is none, and parts it from that again, by changes of the other's copy
/// alone.
TEST(Crumbs, BecomeMaterialAgainWhereOthersAreJoinedToThem) {
  std::size_t n_ended = 0, n_again = 0;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    support::Random random(300 + seed);
    Body body = support::with_copies(support::with_placed_skin(support::block({5, 4, 4}, 0.1)));
    find_crumbs(body);
    cut::Cutter cutter{9};
    cutter.begin(body, rest_positions(body));
    for (int batch = 0; batch < 4; ++batch) {
      const histories::Plan plan = histories::random_plan(random, body, 0.4, 0.2, 0.2);
      CutChange change = cutter.cut(body, {plan.cuts, plan.of_skin, 0});
      surface::place(body, change, {});
      update_crumbs(body, change);
    }
    const auto join = [&](const CopyId crumb, const int face, const CopyId other) {
      Body joined = body;
      for (const auto& [copy, its_face] : {std::pair(crumb, face), {other, face ^ 1}}) {
        CutChange change = join_interval(joined, copy, its_face);
        surface::place(joined, change, {});
        update_crumbs(joined, change);
      }
      EXPECT_TRUE(support::are_crumbs_whole_pieces(joined));
      if (joined.crumbs.holds(crumb))
        return;
      ++n_ended;
      const CellId cell = joined.complex.copies[other].cell;
      joined.cuts.set_joined(cell, {});
      CutChange parted = update_complex(joined, {}, {}, std::array{cell});
      surface::place(joined, parted, {});
      update_crumbs(joined, parted);
      EXPECT_TRUE(support::are_crumbs_whole_pieces(joined) && support::are_loose_pieces_crumbs(joined));
      n_again += joined.crumbs.holds(crumb) ? 1 : 0;
    };
    for (const auto c : ids<CopyId>(body.complex.n_copies())) {
      if (body.complex.copies[c].is_lapsed() || !body.crumbs.holds(c))
        continue;
      for (int face = 0; face < 6; ++face)
        if (const CellId next = body.grid.neighbour(body.complex.copies[c].cell, face); next.valid())
          for (const CopyId other : body.complex.copies_of(next))
            if (!body.crumbs.holds(other))
              join(c, face, other);
    }
  }
  EXPECT_GT(n_ended, 20u);
  EXPECT_GT(n_again, 20u);
}

/// A plane halves a block; what is known of the upper half by samples decides whether it is one.
TEST(Crumbs, AreThoseWhoseSamplesSpanNoVolume) {
  const Points corner = {Vec3(0.1, 0.1, 0.1), Vec3(0.2, 0.1, 0.1), Vec3(0.1, 0.2, 0.1)};
  const auto with = [&](Points more) {
    more.insert(more.begin(), corner.begin(), corner.end());
    return more;
  };
  const std::vector<std::pair<Points, bool>> cases = {{{}, true},
                                                      {corner, true},
                                                      {with({Vec3(0.2, 0.2, 0.1), Vec3(0.3, 0.3, 0.11)}), true},
                                                      {with({Vec3(0.1, 0.1, 0.2)}), true},
                                                      {with({Vec3(0.1, 0.1, 0.2), Vec3(0.2, 0.2, 0.2)}), false}};
  for (const auto& [above, is_crumb] : cases) {
    Body body = support::with_copies(support::with_placed_skin(support::block({4, 4, 6}, 0.1)));
    find_crumbs(body);
    cut::Cutter cutter{9};
    cutter.begin(body, rest_positions(body));
    Points samples;
    for (const auto n : ids<NodeId>(body.grid.n_nodes()))
      if (const Vec3 p = body.grid.position(n); body.grid.is_material(n) && p[2] < 0.32)
        samples.push_back(p + Vec3(0.01, 0.01, -0.01));
    for (const Vec3& p : above)
      samples.push_back(p + Vec3(0.01, 0.01, 0.33));
    CutChange change = cutter.cut(body, support::cuts_of_plane(body, {Vec3::UnitZ(), 0.35}, 1));
    surface::place(body, change, {});
    update_crumbs(body, change, &samples);
    EXPECT_EQ(body.crumbs.all.size(), is_crumb ? 1u : 0u) << above.size() << " above";
    for (const Crumb& crumb : body.crumbs.all)
      for (const CopyId c : crumb.copies)
        EXPECT_GE(body.grid.origin(body.complex.copies[c].cell)[2], 0.25);
  }
}

} // namespace
} // namespace kerf::grid::crumbs_test
