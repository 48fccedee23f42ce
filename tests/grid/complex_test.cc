/// The complex of copies against a slow one made from the definitions of grid/complex.h, on random cut sets and on
/// embedded bodies.

#include "grid/complex.h"

#include "cut/embed.h"
#include "geometry/solid.h"
#include "tests/geometry/meshes.h"
#include "tests/grid/histories.h"
#include "tests/grid/slow_complex.h"
#include "tests/support/bodies.h"
#include "tests/support/same.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <map>
#include <set>
#include <stdexcept>

namespace kerf::grid {
namespace {

using histories::Plan;
using slow::Items;
using slow::SlowComplex;
using support::Body;
using support::Random;
using support::uniform;

/// True when two numberings name the same classes.
class SameClasses {
 public:
  bool add(const std::uint32_t a, const int b) {
    return to_b_.emplace(a, b).first->second == b && to_a_.emplace(b, a).first->second == a;
  }
  std::size_t size() const { return to_b_.size(); }

 private:
  std::map<std::uint32_t, int> to_b_;
  std::map<int, std::uint32_t> to_a_;
};

/// For each copy of the complex, the slow copy with the same cell and material.
std::vector<int> match_copies(const Body& body, const CellComplex& complex, const SlowComplex& slow) {
  std::map<std::pair<Index3, Items>, int> by_content;
  for (int i = 0; i < static_cast<int>(slow.copies.size()); ++i)
    by_content[{slow.copies[i].cell, slow.copies[i].said}] = i;
  std::vector<int> match;
  for (const Copy& copy : complex.copies) {
    const Index3 cell = slow::lattice_cell(body.grid, copy.cell);
    const auto found = by_content.find({cell, slow::named(material_of(body.grid, copy.cell), copy.part(), cell)});
    match.push_back(found == by_content.end() ? -1 : found->second);
  }
  return match;
}

void expect_matches_slow(const Body& body, const CellComplex& complex) {
  const SlowComplex slow = slow::slow_complex(body);
  ASSERT_EQ(complex.n_copies(), slow.copies.size());
  const auto match = match_copies(body, complex, slow);
  const Pieces all = pieces(complex);
  SameClasses corners, same_pieces;
  for (const auto c : ids<CopyId>(complex.n_copies())) {
    ASSERT_GE(match[c.value], 0) << "no such part";
    for (int v = 0; v < 8; ++v)
      ASSERT_TRUE(corners.add(complex.copies[c].corners[v].value, slow.instance[match[c.value]][v]));
    ASSERT_TRUE(same_pieces.add(all.piece[c], slow.piece[match[c.value]]));
  }
  EXPECT_EQ(corners.size(), complex.n_corners());
  EXPECT_EQ(same_pieces.size(), all.n_pieces);
}

/// The copies of a cell are in the order of their parts, and each is found by its material.
void expect_listed(const Body& body, const CellComplex& complex, const CellId cell) {
  const CellCuts cuts = cuts_of(body, cell);
  std::array<CopyId, skeleton::n_items> of_item;
  int last = -1;
  for (const CopyId c : complex.copies_of(cell)) {
    const Copy& copy = complex.copies[c];
    ASSERT_EQ(copy.cell, cell);
    ASSERT_NE(copy.items(), 0u);
    const int rank = std::countr_zero(copy.items());
    ASSERT_LT(last, rank);
    last = rank;
    for (int item = 0; item < skeleton::n_items; ++item)
      if (copy.items() >> item & 1) {
        ASSERT_FALSE(of_item[item].valid()) << "in two copies";
        of_item[item] = c;
      }
  }
  for (int item = 0; item < skeleton::n_items; ++item) {
    const bool is_said = item < skeleton::first_on_line || cuts.is_cut_at_skin();
    ASSERT_EQ(of_item[item].valid(), is_said && (cuts.skeleton().items >> item & 1) != 0);
    ASSERT_EQ(complex.copy_with(cell, item), of_item[item]);
    if (item < skeleton::first_on_line) {
      ASSERT_EQ(complex.copy_at(cell, item), of_item[item]);
    }
  }
}

/// Invariant 2, and that every table says the same thing.
void expect_consistent(const Body& body, const CellComplex& complex) {
  std::vector<std::set<CornerId>> holders(body.grid.n_nodes());
  ASSERT_EQ(complex.first_copy.size(), body.grid.n_cells());
  std::size_t n_listed = 0;
  for (const auto cell : ids<CellId>(body.grid.n_cells())) {
    expect_listed(body, complex, cell);
    for (const CopyId c : complex.copies_of(cell)) {
      const Copy& copy = complex.copies[c];
      for (int v = 0; v < 8; ++v) {
        const NodeId node = body.grid.nodes(copy.cell)[v];
        ASSERT_EQ(complex.node[copy.corners[v]], node);
        if (copy.nodes >> v & 1)
          holders[node.value].insert(copy.corners[v]);
      }
      ++n_listed;
    }
  }
  ASSERT_EQ(n_listed, complex.n_copies());
  for (const auto n : ids<NodeId>(body.grid.n_nodes())) {
    ASSERT_EQ(holders[n.value].size(), body.grid.is_material(n) ? 1u : 0u);
    ASSERT_EQ(complex.real_corner[n], holders[n.value].empty() ? CornerId() : *holders[n.value].begin());
  }
}

/// A piece is exactly what uncut segments hold together, through the body, whatever its cells: the cells around an item
/// all exist, any two of them that share a face are glued there, and glued copies share an item.
void expect_pieces_of_material(const Body& body, const CellComplex& complex) {
  const Pieces all = pieces(complex);
  std::map<slow::Item, std::set<std::uint32_t>> pieces_at;
  for (const auto c : ids<CopyId>(complex.n_copies())) {
    const CellId cell = complex.copies[c].cell;
    for (const auto& item :
         slow::named(material_of(body.grid, cell), complex.copies[c].part(), slow::lattice_cell(body.grid, cell)))
      pieces_at[item].insert(all.piece[c]);
  }
  std::set<std::uint32_t> seen;
  for (const Items& items : slow::pieces_of(body)) {
    std::set<std::uint32_t> of_items;
    for (const auto& item : items)
      of_items.insert(pieces_at[item].begin(), pieces_at[item].end());
    ASSERT_EQ(of_items.size(), 1u);
    ASSERT_TRUE(seen.insert(*of_items.begin()).second) << "two in one piece";
  }
  EXPECT_EQ(seen.size(), all.n_pieces);
}

/// Built again, and up to names after an update.
void expect_same(const CellComplex& a, const CellComplex& b) { ASSERT_TRUE(support::renaming(a, b).has_value()); }

/// The copy in which one item of a copy was: a point of the skin that had not been told of, with the node under it.
CopyId copy_before(const Body& body, const CellComplex& before, const CellId cell, const int item) {
  const CopyId c = before.copy_with(cell, item);
  return c.valid() ? c : before.copy_at(cell, skeleton_of(material_of(body.grid, cell)).vertex[item]);
}
CopyId copy_before(const Body& body, const CellComplex& before, const Copy& copy) {
  return copy_before(body, before, copy.cell, std::countr_zero(copy.items()));
}

/// One parent a corner, an instance of the same node, whichever copy is asked; real stays real; pieces only split; what
/// is not named as changed has not.
void expect_change(const Body& body, const CellComplex& before, const CellComplex& after, const CutChange& change) {
  ASSERT_EQ(change.n_copies_before, before.n_copies());
  ASSERT_EQ(change.n_corners_before, before.n_corners());
  ASSERT_EQ(change.parents.size(), after.n_corners() - before.n_corners());
  const auto parent = [&](const CornerId corner) {
    return corner.value < before.n_corners() ? corner : change.parents[corner.value - before.n_corners()];
  };
  for (const auto corner : ids<CornerId>(after.n_corners())) {
    ASSERT_LT(parent(corner).value, before.n_corners());
    ASSERT_EQ(before.node[parent(corner)], after.node[corner]);
  }
  ASSERT_TRUE(std::is_sorted(change.copies.begin(), change.copies.end()));
  ASSERT_TRUE(std::is_sorted(change.reshaped.begin(), change.reshaped.end()));
  ASSERT_EQ(std::adjacent_find(change.copies.begin(), change.copies.end()), change.copies.end()) << "named twice";
  const Pieces pieces_before = pieces(before), pieces_after = pieces(after);
  std::set<CopyId> divided;
  for (const auto c : ids<CopyId>(after.n_copies()))
    if (const CopyId from = copy_before(body, before, after.copies[c]); from != c)
      divided.insert(from);
  std::map<std::uint32_t, std::uint32_t> piece_before;
  for (const auto c : ids<CopyId>(after.n_copies())) {
    const Copy& copy = after.copies[c];
    const bool same = c.value < before.n_copies() && before.copies[c].nodes == copy.nodes &&
                      before.copies[c].skin == copy.skin && before.copies[c].corners == copy.corners &&
                      !divided.contains(c);
    ASSERT_NE(same, std::binary_search(change.copies.begin(), change.copies.end(), c));
    const CopyId from = copy_before(body, before, copy);
    ASSERT_TRUE(from.valid());
    for (int item = 0; item < skeleton::n_items; ++item)
      if (copy.items() >> item & 1) {
        ASSERT_EQ(copy_before(body, before, copy.cell, item), from) << "cuts join nothing";
      }
    for (int v = 0; v < 8; ++v)
      ASSERT_EQ(parent(copy.corners[v]), before.copies[from].corners[v]);
    const std::uint32_t piece = pieces_before.piece[from];
    ASSERT_EQ(piece_before.emplace(pieces_after.piece[c], piece).first->second, piece);
  }
  ASSERT_EQ(after.real_corner.items(), before.real_corner.items()) << "a real corner keeps its name";
}

/// The change names what was cut, the cells that it is cut in, and their copies as those of another shape.
void expect_reshaped(const Body& body, const histories::Step& step, const CutChange& change) {
  ASSERT_EQ(change.edges, step.edges());
  ASSERT_EQ(change.segments, step.segments());
  std::set<CellId> cells;
  for (const auto c : ids<CellId>(body.grid.n_cells())) {
    const auto edges = body.grid.edges(c);
    const auto faces = body.grid.faces(c);
    for (const EdgeCut& cut : step.cuts)
      if (std::ranges::find(edges, cut.edge) != edges.end())
        cells.insert(c);
    for (const auto& [segment, t, normal, label] : step.of_skin)
      if (segment.face.valid() ? std::ranges::find(faces, segment.face) != faces.end() : segment.cell == c)
        cells.insert(c);
  }
  ASSERT_EQ(change.cells, std::vector<CellId>(cells.begin(), cells.end()));
  std::set<CopyId> copies(change.copies.begin(), change.copies.end());
  for (const auto c : ids<CopyId>(body.complex.n_copies()))
    if (cells.contains(body.complex.copies[c].cell))
      copies.insert(c);
  ASSERT_EQ(change.reshaped, std::vector<CopyId>(copies.begin(), copies.end()));
}

/// Follows a plan in a random order and in random steps; after each of them, updated is built.
void expect_updates(Random& random, Body body, const Plan& plan, const std::size_t n_steps) {
  body.complex = build_complex(body);
  for (const histories::Step& step : histories::dealt(random, plan, n_steps)) {
    histories::apply(step, body);
    const CellComplex before = body.complex;
    const CutChange change = update_complex(body, step.edges(), step.segments());
    expect_change(body, before, body.complex, change);
    expect_consistent(body, body.complex);
    expect_same(body.complex, build_complex(body));
    expect_reshaped(body, step, change);
    if (testing::Test::HasFatalFailure())
      return;
  }
}

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

TEST(Complex, OfAnUncutBodyIsItsGrid) {
  for (const Index3& n : {Index3{1, 1, 1}, {2, 3, 4}, {1, 5, 2}}) {
    const Body body = support::with_copies(support::block(n, 0.5));
    const CellComplex& complex = body.complex;
    EXPECT_EQ(complex.n_copies(), body.grid.n_cells());
    EXPECT_EQ(complex.n_corners(), body.grid.n_nodes());
    EXPECT_EQ(grid::n_pieces(complex), 1u);
    const Points x = rest_positions(body);
    for (const auto corner : ids<CornerId>(complex.n_corners()))
      EXPECT_EQ(x[corner.value], body.grid.position(complex.node[corner]));
    expect_consistent(body, complex);
  }
}

TEST(Complex, HasTwoCopiesAtTheFaceOfAFront) {
  // Four nodes in a ring, its lower x edge cut, and the skin around that: the cell through the ring holds one component,
  // the one below it two.
  Body body = support::block({2, 1, 2});
  body.cuts.add(body.grid, {*body.grid.find_edge({1, 1, 1}, 0), 0.5, Vec3::UnitX(), 1});
  for (const SkinCut& cut : support::plane_skin_cuts(body, {Vec3::UnitX(), 1.5}))
    if (const auto& [f, c, place] = cut.segment; (f.valid() ? centre(body.grid, f) : centre(body.grid, c))[2] < 1.25)
      body.cuts.add(cut);
  const CellComplex complex = build_complex(body);
  const CellId below = *body.grid.find_cell({1, 1, 0}), above = *body.grid.find_cell({1, 1, 1});
  EXPECT_TRUE(complex.copies[complex.first_copy[below]].next.valid());
  EXPECT_FALSE(complex.copies[complex.first_copy[above]].next.valid());
  EXPECT_EQ(grid::n_pieces(complex), 1u);
  const CornerId left = complex.real_corner[*body.grid.find_node({1, 1, 1})];
  const Copy& joined = complex.copies[complex.copy_at(above, 0)];
  EXPECT_EQ(joined.corners[0], left);
  EXPECT_EQ(complex.copies[complex.copy_at(below, 4)].corners[5], joined.corners[1]) << "glued along the whole face";
  EXPECT_EQ(complex.copies[complex.copy_at(below, 5)].corners[4], joined.corners[0]) << "glued along the whole face";
  EXPECT_NE(complex.copies[complex.copy_at(below, 4)].corners[1], complex.copies[complex.copy_at(below, 5)].corners[1]);
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
  const std::string liver = std::string(KERF_SOURCE_DIR) + "/params/meshes/liver_25k.off";
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

/// A plane leaves nothing joined across it where it cuts all that it crosses, skin and all.
TEST(Complex, FallsApartAtAPlane) {
  Random random(12);
  for (int i = 0; i < 40; ++i) {
    auto nodes = support::some_nodes(random, {3, 3, 3}, uniform(random, 0.3, 1));
    nodes.push_back({2, 2, 2});
    const Body blank = support::make_body({}, nodes, [&](const Grid& grid, const EdgeId e) {
      EdgeCut cut = support::midway(grid, e);
      cut.t = uniform(random, 0.01, 0.99);
      return cut;
    });
    const Vec3 normal = support::random_direction(random);
    const support::Plane plane{normal, normal.dot(Vec3(2, 2, 2) + 0.5 * support::random_vector(random))};
    const Body body = support::with_copies(
      histories::applied({support::plane_cuts(blank, plane), support::plane_skin_cuts(blank, plane)}, blank));
    const Pieces all = pieces(body.complex);
    std::map<std::uint32_t, bool> is_above;
    for (const auto c : ids<CopyId>(body.complex.n_copies())) {
      const Copy& copy = body.complex.copies[c];
      for (grid::Items left = copy.items(); left != 0; left &= left - 1) {
        const bool above = plane.height(item_point(body, copy.cell, std::countr_zero(left))) >= 0;
        ASSERT_EQ(is_above.emplace(all.piece[c], above).first->second, above) << "random body " << i;
      }
    }
  }
}

TEST(Complex, GivesSkinThatIsCutOffCopiesOfItsOwn) {
  // One node in eight cells; its edge along x is cut a second time, then the skin around its end segment by segment.
  Body body = support::with_copies(support::block({1, 1, 1}));
  const CellComplex& complex = body.complex;
  const EdgeId edge = *body.grid.find_edge({1, 1, 1}, 0);
  const std::array<CellId, 4> around = body.grid.cells(edge);
  const auto expect = [&](const std::vector<EdgeId>& edges, const std::vector<SkinSegment>& segments,
                          const std::size_t n_copies, const std::size_t n_corners, const std::uint32_t n_pieces) {
    for (const EdgeId e : edges)
      body.cuts.add(body.grid, {e, 0.2, Vec3::UnitX(), 1});
    for (const SkinSegment& segment : segments)
      body.cuts.add({segment, 0.3, Vec3::UnitX(), 1});
    update_complex(body, edges, segments);
    EXPECT_EQ(complex.n_copies(), n_copies);
    EXPECT_EQ(complex.n_corners(), n_corners);
    EXPECT_EQ(grid::n_pieces(complex), n_pieces);
    expect_consistent(body, complex);
    expect_matches_slow(body, complex);
  };
  const auto half = [&](const int cell, const int face) { // of the arc in a face of one of the cells, at the edge
    const auto edges = body.grid.edges(around[cell]);
    const int line = static_cast<int>(std::ranges::find(edges, edge) - edges.begin());
    return SkinSegment::half(body.grid.faces(around[cell])[face], cube::place_in_face(face, line));
  };
  const auto spoke = [&](const int cell) {
    const auto edges = body.grid.edges(around[cell]);
    return SkinSegment::spoke(around[cell], static_cast<int>(std::ranges::find(edges, edge) - edges.begin()));
  };
  // The cells around the edge: 0 above it in y and z, 1 below in y, 2 below in z, 3 below in both.
  expect({edge}, {}, 8, 27, 1);                                 // the skin still holds all
  expect({}, {half(0, 2), half(0, 4), spoke(0)}, 9, 27 + 2, 1); // alone in the first cell: two on that cell's own edge
  expect({}, {half(1, 4), spoke(1)}, 10, 27 + 6, 1);            // in two cells side by side: six on their far side
  expect({}, {half(2, 2), spoke(2), spoke(3)}, 12, 27 + 18, 2); // on its own in four cells
}

/// Each item its own copy: nothing is glued but by what it is.
TEST(Complex, OfANodeWithAllCutFallsIntoItsItems) {
  Body body = support::block({1, 1, 1});
  for (const EdgeId e : body.grid.skin_edges())
    body.cuts.add(body.grid, {e, body.grid.is_material(body.grid.ends(e)[0]) ? 0.2 : 0.8, Vec3::UnitX(), 1});
  for (const SkinSegment& segment : histories::skin_segments(body.grid))
    body.cuts.add({segment, 0.5, Vec3::UnitX(), 1});
  EXPECT_EQ(body.cuts.skin_cuts().size(), 12u * 2 + 8 * 6);
  body.complex = build_complex(body);
  EXPECT_EQ(body.complex.n_copies(), 8u * (1 + 3 + 3 + 1));
  EXPECT_EQ(grid::n_pieces(body.complex), 1u + 6 + 12 + 8);
  expect_consistent(body, body.complex);
  expect_matches_slow(body, body.complex);
}

/// Does a part hold what was in several?
bool has_joined(const Body& before, const Body& after) {
  std::map<std::pair<Index3, slow::Item>, std::size_t> copy_of;
  const auto old = slow::slow_copies(before);
  for (std::size_t i = 0; i < old.size(); ++i)
    for (const auto& item : old[i].items)
      copy_of[{old[i].cell, item}] = i;
  for (const slow::SlowCopy& copy : slow::slow_copies(after)) {
    std::set<std::size_t> from;
    for (const auto& item : copy.items)
      from.insert(copy_of.at({copy.cell, item}));
    if (from.size() > 1)
      return true;
  }
  return false;
}

/// Where blades had cut at the skin of a cell, have they still?
bool is_cut_at_skin_still(const Body& before, const Body& after) {
  for (const auto c : ids<CellId>(before.grid.n_cells()))
    if (cuts_of(before, c).is_cut_at_skin() && !cuts_of(after, c).is_cut_at_skin())
      return false;
  return true;
}

/// Cuts that are taken back after the complex has been built with them.
TEST(Complex, RefusesExactlyTheCutsThatJoin) {
  Random random(7);
  int n_refused = 0, n_taken = 0;
  for (int i = 0; i < 300; ++i) {
    auto nodes = support::some_nodes(random, {2, 2, 2}, uniform(random, 0.3, 1));
    nodes.push_back({1, 1, 1});
    const Body blank = support::make_body({}, nodes, support::midway);
    const Plan plan =
      histories::random_plan(random, blank, uniform(random, 0, 1), uniform(random, 0.2, 1), uniform(random, 0.05, 1));
    if (plan.of_skin.empty())
      continue;
    const Body before = support::with_copies(histories::applied(plan, blank));
    Body after = before;
    const SkinSegment taken = plan.of_skin[random() % plan.of_skin.size()].segment;
    after.cuts.take_back(std::array{taken});
    const Plan more = histories::random_plan(random, after, 0, random() % 2 ? 0.2 : 0, 0);
    histories::apply(more, after);
    if (has_joined(before, after)) {
      EXPECT_THROW(update_complex(after, more.edges(), {taken}), std::logic_error);
      ++n_refused;
    } else if (is_cut_at_skin_still(before, after)) {
      ASSERT_NO_THROW(update_complex(after, more.edges(), {taken}));
      expect_same(after.complex, build_complex(after));
      ++n_taken;
    }
    ASSERT_FALSE(HasFatalFailure()) << "random body " << i;
  }
  EXPECT_GT(n_refused, 20);
  EXPECT_GT(n_taken, 50);
}

} // namespace
} // namespace kerf::grid
