/// The parts of cells and faces, and the arcs of the skin, against slow_parts.h.

#include "grid/parts.h"

#include "tests/grid/histories.h"
#include "tests/grid/slow_parts.h"

#include <gtest/gtest.h>

#include <bit>
#include <map>
#include <numeric>
#include <set>

namespace kerf::grid {
namespace {

using slow::Items;
using slow::Point;
using support::Body;
using support::Random;
using support::uniform;

/// Whatever cuts and seams can be: any line between material vertices may be cut, any line of the skin twice.
CellCuts random_cell(Random& random, const unsigned material) {
  CellCuts cell;
  cell.material = material;
  const double inner = uniform(random, 0, 1), second = uniform(random, 0, 1), parted = uniform(random, 0, 1);
  for (int line = 0; line < 12; ++line) {
    const auto& [v, w] = cube::line_vertices[line];
    const unsigned n_material = (material >> v & 1) + (material >> w & 1), bit = 1u << line;
    if (n_material == 1) {
      cell.skin |= bit;
      cell.cut |= bit;
      cell.twice |= uniform(random, 0, 1) < second ? bit : 0;
    } else if (n_material == 2) {
      cell.cut |= uniform(random, 0, 1) < inner ? bit : 0;
    }
  }
  const bool is_said = random() % 4 != 0;
  for (Seam& seam : cell.seams)
    if (is_said)
      seam = uniform(random, 0, 1) < parted ? Seam::parted : static_cast<Seam>(random() % 2);
  return cell;
}

/// Each set of material vertices, so many times.
template <class Check>
void for_random_cells(const unsigned seed, const int n_each, const Check& check) {
  Random random(seed);
  for (unsigned material = 0; material < 256; ++material)
    for (int i = 0; i < n_each; ++i) {
      check(random_cell(random, material));
      ASSERT_FALSE(testing::Test::HasFatalFailure()) << "material " << material << ", " << i;
    }
}

std::set<Items> as_sets(const Parts& parts, const Index3& cell = {}) {
  std::set<Items> sets;
  for (const Part& part : parts)
    sets.insert(slow::items_of(part, cell));
  return sets;
}

std::set<Items> as_sets(const std::vector<Items>& parts) { return {parts.begin(), parts.end()}; }

/// The order that is promised.
void expect_ordered(const Parts& parts) {
  const auto rank = [](const Part& part) {
    return part.nodes != 0 ? std::countr_zero(part.nodes) : 8 + std::countr_zero(part.rinds);
  };
  for (const Part& part : parts)
    ASSERT_TRUE(part.nodes != 0 || part.rinds != 0);
  for (int i = 1; i < parts.n; ++i)
    ASSERT_LT(rank(parts.items[i - 1]), rank(parts.items[i]));
}

TEST(SkinArcs, AreThoseOfAWalkRoundTheFace) {
  std::size_t n_arcs = 0, n_with_two = 0;
  for (int face = 0; face < 6; ++face)
    for (unsigned pattern = 0; pattern < 16; ++pattern) {
      CellCuts cell;
      for (int i = 0; i < 4; ++i)
        cell.material |= (pattern >> i & 1) << cube::face_vertices[face][i];
      using Ends = std::set<std::pair<Point, Point>>; // edge and node, at either end
      std::set<std::pair<Ends, Items>> arcs, walked;
      for (const SkinArc& arc : skin_arcs(face, cell.material)) {
        Ends ends;
        for (int end = 0; end < 2; ++end)
          ends.emplace(slow::line_point({}, arc.lines[end]), slow::node_point({}, arc.vertices[end]));
        arcs.emplace(ends, slow::items_of({0, arc.inner}, {}));
      }
      for (const slow::Arc& arc : slow::arcs(slow::material_of(cell), slow::face_centre({}, face)))
        walked.emplace(Ends{{arc.edges[0], arc.nodes[0]}, {arc.edges[1], arc.nodes[1]}},
                       Items(arc.inner.begin(), arc.inner.end()));
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
  std::size_t n_without_nodes = 0, n_held_by_skin = 0;
  for_random_cells(1, 200, [&](const CellCuts& cell) {
    const Parts parts = parts_of(cell);
    ASSERT_EQ(as_sets(parts), as_sets(slow::parts(slow::material_of(cell), slow::closure({1, 1, 1}))));
    expect_ordered(parts);
    most = std::max(most, parts.n);
    n_without_nodes += parts.n > 0 && parts.items[parts.n - 1].nodes == 0;
    n_held_by_skin += std::any_of(parts.begin(), parts.end(), [&](const Part& part) {
      return part.nodes != 0 && part.nodes != (cube::reachable(std::countr_zero(part.nodes), cell.cut));
    });
  });
  EXPECT_GE(most, 14);
  EXPECT_GT(n_without_nodes, 10000u);
  EXPECT_GT(n_held_by_skin, 2000u) << "nodes that only the skin holds together";
}

TEST(Parts, AreAtMostSixteen) {
  CellCuts cell;
  cell.material = 0b01101001; // no two of them side by side
  cell.cut = cell.twice = cell.skin = 0xfff;
  cell.seams.fill(Seam::parted);
  EXPECT_EQ(parts_of(cell).n, 16);
  cell.seams.fill(Seam::whole);
  EXPECT_EQ(parts_of(cell).n, 8) << "the three rinds of each node hold together";
}

TEST(Parts, OfAFaceAreThoseOfAFlood) {
  for_random_cells(2, 40, [](const CellCuts& cell) {
    for (int face = 0; face < 6; ++face) {
      const Parts parts = parts_of(cell, face);
      ASSERT_EQ(as_sets(parts),
                as_sets(slow::parts(slow::material_of(cell), slow::closure(slow::face_centre({}, face)))));
      expect_ordered(parts);
    }
  });
}

TEST(Parts, OfAFaceHoldTogetherInTheCell) {
  for_random_cells(3, 100, [](const CellCuts& cell) {
    const Parts of_cell = parts_of(cell);
    for (int face = 0; face < 6; ++face)
      for (const Part& part : parts_of(cell, face))
        ASSERT_EQ(std::count_if(of_cell.begin(), of_cell.end(),
                                [&](const Part& whole) {
                                  return (part.nodes & ~whole.nodes) == 0 && (part.rinds & ~whole.rinds) == 0;
                                }),
                  1);
  });
}

TEST(Parts, SayWhereBladesHaveAPointOfTheirOwn) {
  std::size_t n_two = 0, n_rims = 0;
  for_random_cells(4, 40, [&](const CellCuts& cell) {
    const slow::Material material = slow::material_of(cell);
    bool has_blade = false;
    for (int line = 0; line < 12; ++line)
      has_blade |= (cell.skin >> line & 1) ? (cell.twice >> line & 1) != 0 : (cell.cut >> line & 1) != 0;
    ASSERT_EQ(cell.blades() != 0, has_blade);
    ASSERT_EQ(cell.has_two_points(), has_blade && cell.material != 0 && cell.material != 0xff);
    for (int face = 0; face < 6; ++face) {
      const Point centre = slow::face_centre({}, face);
      bool is_beside = false;
      std::size_t n_walked_rims = 0, n_face_rims = 0;
      for (const slow::Arc& arc : slow::arcs(material, centre)) {
        is_beside |= slow::is_beside_cut(material, arc);
        n_walked_rims += slow::is_beside_cut(material, arc) && !slow::is_whole(material, centre, arc);
      }
      for (const SkinArc& arc : skin_arcs(face, cell.material))
        n_face_rims += cell.is_rim(face, arc);
      ASSERT_EQ(cell.has_two_points(face), is_beside);
      ASSERT_EQ(n_face_rims, n_walked_rims);
      n_two += is_beside;
      n_rims += n_face_rims;
    }
  });
  EXPECT_GT(n_two, 1000u);
  EXPECT_GT(n_rims, 1000u);
}

TEST(Parts, FanOutTheSkinBetweenItsRims) {
  std::map<int, std::size_t> n_cells; // by their number of fans
  for_random_cells(7, 40, [&](const CellCuts& cell) {
    const slow::Material material = slow::material_of(cell);
    std::array<int, 12> lowest; // a lower line is handed on over arcs without a rim until nothing changes
    std::iota(lowest.begin(), lowest.end(), 0);
    const auto at = [&](const Point& edge) -> int& {
      int line = 0;
      while (slow::line_point({}, line) != edge)
        ++line;
      return lowest[line];
    };
    for (int round = 0; round < 12; ++round)
      for (int face = 0; face < 6; ++face)
        for (const slow::Arc& arc : slow::arcs(material, slow::face_centre({}, face)))
          if (!slow::is_beside_cut(material, arc) || slow::is_whole(material, slow::face_centre({}, face), arc))
            at(arc.edges[0]) = at(arc.edges[1]) = std::min(at(arc.edges[0]), at(arc.edges[1]));
    const auto fans = fans_of(cell);
    std::set<int> of_skin;
    for (int line = 0; line < 12; ++line) {
      ASSERT_EQ(fans[line], lowest[line]);
      if (cell.skin >> line & 1)
        of_skin.insert(lowest[line]);
    }
    ++n_cells[static_cast<int>(of_skin.size())];
  });
  EXPECT_EQ(n_cells[0], 2u * 40) << "no skin without material, or with nothing else";
  for (int n = 1; n <= 9; ++n)
    EXPECT_GT(n_cells[n], 20u) << n << " fans";
}

/// A symmetry of the cube: where each axis goes, and which axes are turned round.
struct Symmetry {
  std::array<int, 3> axes;
  unsigned turned;

  Point operator()(const Point& p) const {
    Point q{};
    for (int axis = 0; axis < 3; ++axis)
      q[axes[axis]] = (turned >> axis & 1) != 0 ? 2 - p[axis] : p[axis];
    return q;
  }
  /// The bits of vertices, lines or faces, by the points of each.
  template <class PointOf>
  unsigned bits(const unsigned from, const int n, const PointOf& point) const {
    unsigned to = 0;
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j)
        if ((from >> i & 1) && point(Index3{}, j) == (*this)(point(Index3{}, i)))
          to |= 1u << j;
    return to;
  }
  CellCuts operator()(const CellCuts& cell) const {
    CellCuts image;
    image.material = bits(cell.material, 8, slow::node_point);
    image.cut = bits(cell.cut, 12, slow::line_point);
    image.twice = bits(cell.twice, 12, slow::line_point);
    image.skin = bits(cell.skin, 12, slow::line_point);
    for (int face = 0; face < 6; ++face)
      image.seams[std::countr_zero(bits(1u << face, 6, slow::face_centre))] = cell.seams[face];
    return image;
  }
};

std::vector<Symmetry> symmetries() {
  std::vector<Symmetry> all;
  std::array<int, 3> axes = {0, 1, 2};
  do
    for (unsigned turned = 0; turned < 8; ++turned)
      all.push_back({axes, turned});
  while (std::next_permutation(axes.begin(), axes.end()));
  return all;
}

TEST(Parts, TurnWithTheCube) {
  ASSERT_EQ(symmetries().size(), 48u);
  for (const Symmetry& symmetry : symmetries())
    for_random_cells(5, 1, [&](const CellCuts& cell) {
      const CellCuts image = symmetry(cell);
      const auto turned = [&](const Parts& parts) {
        std::set<Items> sets;
        for (const Items& part : as_sets(parts)) {
          Items items;
          for (const Point& p : part)
            items.insert(symmetry(p));
          sets.insert(items);
        }
        return sets;
      };
      ASSERT_EQ(as_sets(parts_of(image)), turned(parts_of(cell)));
      for (int face = 0; face < 6; ++face) {
        const int to = std::countr_zero(symmetry.bits(1u << face, 6, slow::face_centre));
        ASSERT_EQ(as_sets(parts_of(image, to)), turned(parts_of(cell, face)));
        ASSERT_EQ(image.has_two_points(to), cell.has_two_points(face));
      }
    });
}

TEST(Parts, AreThoseOfAllWhoShareThem) {
  Random random(6);
  std::size_t n_faces = 0;
  for (int i = 0; i < 120; ++i) {
    auto nodes = support::some_nodes(random, {4, 3, 3}, uniform(random, 0.2, 1));
    nodes.push_back({2, 2, 2});
    const Body blank = support::make_body({}, nodes, support::midway);
    const Body body = histories::applied(
      histories::random_plan(random, blank, uniform(random, 0, 0.8), uniform(random, 0, 1), uniform(random, 0, 1)),
      blank);
    const slow::Material material = slow::material_of(body);
    const auto lattice_cell = [&](const CellId c) { return body.grid.index(body.grid.nodes(c)[0]); };
    for (const auto c : ids<CellId>(body.grid.n_cells()))
      ASSERT_EQ(as_sets(parts_of(cuts_of(body, c)), lattice_cell(c)),
                as_sets(slow::parts(material, slow::closure(slow::cell_centre(lattice_cell(c))))));
    for (const auto f : ids<FaceId>(body.grid.n_faces())) {
      const auto& [below, above] = body.grid.cells(f);
      if (!below.valid() || !above.valid())
        continue;
      const auto faces = body.grid.faces(above);
      const int face = static_cast<int>(std::find(faces.begin(), faces.end(), f) - faces.begin());
      const CellCuts lower = cuts_of(body, below), upper = cuts_of(body, above);
      ASSERT_EQ(as_sets(parts_of(lower, face + 1), lattice_cell(below)),
                as_sets(parts_of(upper, face), lattice_cell(above)));
      ASSERT_EQ(lower.has_two_points(face + 1), upper.has_two_points(face));
      ++n_faces;
    }
  }
  EXPECT_GT(n_faces, 6000u);
}

} // namespace
} // namespace kerf::grid
