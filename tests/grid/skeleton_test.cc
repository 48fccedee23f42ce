/// The skeletons of all 256 cells against walks over their skin (slow_parts.h), and the surfaces that their sides make.

#include "grid/skeleton.h"

#include "grid/material.h"
#include "tests/grid/symmetries.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <bit>
#include <numeric>

namespace kerf::grid::skeleton_test {
namespace {

using slow::Item;
using slow::Items;
using support::Body;
using support::Random;
using support::uniform;

/// A closed row of items, from its lowest one on.
using Row = std::vector<Item>;
Row from_lowest(Row row) {
  std::rotate(row.begin(), std::ranges::min_element(row), row.end());
  return row;
}
Row backwards(Row row) {
  std::ranges::reverse(row);
  return from_lowest(row);
}

Row named_side(const unsigned material, const int side, const Index3& cell = {}) {
  const Skeleton::Side& of = skeleton_of(material).side[side];
  Row row;
  for (int i = 0; i < of.n; ++i)
    row.push_back(slow::named(material, of.items[i], cell));
  return from_lowest(row);
}

slow::Material uncut(const unsigned material) { return slow::material_of(CellCuts{material, 0, 0}); }

bool has(const std::uint64_t set, const int i) { return (set >> i & 1) != 0; }

TEST(Skeleton, HasTheItemsAndSegmentsOfAWalk) {
  for (unsigned material = 0; material < 256; ++material) {
    const Skeleton& skeleton = skeleton_of(material);
    Items items, walked_items;
    for (int i = 0; i < 64; ++i)
      if (has(skeleton.items, i)) {
        ASSERT_LT(i, skeleton::n_items);
        ASSERT_TRUE(items.insert(slow::named(material, i)).second) << "two items are one";
      }
    std::set<slow::Segment> segments;
    for (int s = 0; s < 64; ++s)
      if (has(skeleton.segments, s)) {
        ASSERT_LT(s, skeleton::n_segments);
        for (const int end : skeleton.segment[s].ends)
          ASSERT_TRUE(has(skeleton.items, end));
        ASSERT_TRUE(segments.insert(slow::named_segment(material, s)).second) << "two segments are one";
      }
    const slow::Material of = uncut(material);
    const auto walked = slow::segments(of, slow::closure({1, 1, 1}));
    ASSERT_EQ(segments, walked) << material;
    for (const Items& part : slow::parts(of, slow::closure({1, 1, 1})))
      walked_items.insert(part.begin(), part.end());
    ASSERT_EQ(items, walked_items) << material;
    ASSERT_EQ(skeleton.n_loops, static_cast<int>(slow::loops(of, {1, 1, 1}).size()));
  }
}

/// What the numbers promise, beyond which items and segments there are.
TEST(Skeleton, NumbersByPlace) {
  using namespace skeleton;
  for (unsigned material = 0; material < 256; ++material) {
    const Skeleton& s = skeleton_of(material);
    int loop = 0;
    for (int line = 0; line < cube::n_lines; ++line) {
      const auto& [v, w] = cube::line_vertices[line];
      const bool of_skin = ((material >> v ^ material >> w) & 1) != 0;
      ASSERT_EQ(has(s.items, on_line(line)), of_skin);
      ASSERT_EQ(has(s.segments, spoke(line)), of_skin);
      ASSERT_EQ(has(s.segments, line), of_skin || ((material >> v & material >> w) & 1) != 0);
      if (!of_skin)
        continue;
      const int node = (material >> v & 1) != 0 ? v : w;
      ASSERT_EQ(s.vertex[on_line(line)], node);
      ASSERT_EQ(int(s.segment[line].ends[0]), node);
      ASSERT_EQ(int(s.segment[line].ends[1]), on_line(line));
      ASSERT_EQ(int(s.segment[spoke(line)].ends[0]), on_line(line));
      ASSERT_EQ(int(s.segment[spoke(line)].ends[1]), middle(s.loop[line]));
      ASSERT_LE(s.loop[line], loop) << "rows are numbered by their lowest lines";
      loop += s.loop[line] == loop;
    }
    ASSERT_EQ(s.n_loops, loop);
    for (int face = 0; face < cube::n_faces; ++face)
      for (int place = 0; place < 4; ++place) {
        const int line = cube::face_lines[face][place];
        ASSERT_EQ(has(s.segments, half(face, place)), has(s.items, on_line(line)));
        ASSERT_EQ(has(s.sides, triangle(face, place)), has(s.items, on_line(line)));
        if (!has(s.items, on_line(line)))
          continue;
        const int corner = s.segment[half(face, place)].ends[1], arc = corner - on_arc(face, 0);
        ASSERT_EQ(int(s.segment[half(face, place)].ends[0]), on_line(line));
        ASSERT_TRUE(arc == 0 || arc == 1);
        ASSERT_TRUE(has(s.sides, polygon(face, arc)));
        ASSERT_EQ(int(s.segment[arc_spoke(face, arc)].ends[0]), corner);
        ASSERT_EQ(int(s.segment[arc_spoke(face, arc)].ends[1]), middle(s.loop[line]));
        ASSERT_TRUE(slow::named(material, corner).of.contains(slow::node_point({}, s.vertex[corner])));
        ASSERT_EQ(slow::named_segment(material, half(face, place)).size(), 2u);
      }
    for (int k = 0; k < s.n_loops; ++k) {
      bool is_node_of_row = false;
      for (int line = 0; line < cube::n_lines; ++line)
        is_node_of_row |=
          has(s.items, on_line(line)) && s.loop[line] == k && s.vertex[on_line(line)] == s.vertex[middle(k)];
      ASSERT_TRUE(is_node_of_row);
    }
  }
}

TEST(Skeleton, HasTheSidesOfAWalk) {
  for (unsigned material = 0; material < 256; ++material) {
    const Skeleton& skeleton = skeleton_of(material);
    std::set<Row> sides, walked; // either way round
    for (int side = 0; side < skeleton::n_sides; ++side) {
      ASSERT_EQ(has(skeleton.sides, side), skeleton.side[side].n > 0);
      if (!has(skeleton.sides, side))
        continue;
      const Row row = named_side(material, side);
      ASSERT_TRUE(sides.insert(std::min(row, backwards(row))).second);
    }
    for (const Row& row : slow::sides(uncut(material), {1, 1, 1}))
      walked.insert(std::min(from_lowest(row), backwards(row)));
    ASSERT_EQ(sides, walked) << material;
  }
}

TEST(Skeleton, HasClosedSidesThatMeetInOppositeDirections) {
  for (unsigned material = 0; material < 256; ++material) {
    const Skeleton& skeleton = skeleton_of(material);
    std::map<std::pair<int, int>, int> passed; // segment, from which of its ends: the side
    for (int s = 0; s < skeleton::n_sides; ++s) {
      const Skeleton::Side& side = skeleton.side[s];
      for (int i = 0; i < side.n; ++i) {
        const int from = side.items[i], to = side.items[(i + 1) % side.n], segment = side.segments[i];
        const auto& ends = skeleton.segment[segment].ends;
        ASSERT_TRUE(has(skeleton.segments, segment));
        ASSERT_TRUE((ends[0] == from && ends[1] == to) || (ends[1] == from && ends[0] == to)) << "it joins its items";
        ASSERT_TRUE(passed.emplace(std::pair(segment, ends[0] == from ? 0 : 1), s).second) << "passed twice";
      }
    }
    for (int s = 0; s < skeleton::n_segments; ++s)
      for (const int way : {0, 1}) {
        ASSERT_EQ(passed.contains({s, way}), has(skeleton.segments, s));
        if (has(skeleton.segments, s)) {
          ASSERT_EQ(int(skeleton.segment[s].sides[way]), passed.at({s, way}));
        }
      }
  }
}

/// Every closed surface is a ball's, one for each set of nodes that edges join.
TEST(Skeleton, BoundsBalls) {
  for (unsigned material = 0; material < 256; ++material) {
    const Skeleton& skeleton = skeleton_of(material);
    std::map<Items, int> characteristic; // V - E + F by the items that segments join
    const auto parts = slow::parts(uncut(material), slow::closure({1, 1, 1}));
    const auto part_of = [&](const int item) -> int& {
      const auto part =
        std::ranges::find_if(parts, [&](const Items& items) { return items.contains(slow::named(material, item)); });
      return characteristic[*part];
    };
    for (int i = 0; i < skeleton::n_items; ++i)
      if (has(skeleton.items, i))
        ++part_of(i);
    for (int s = 0; s < skeleton::n_segments; ++s)
      if (has(skeleton.segments, s))
        --part_of(skeleton.segment[s].ends[0]);
    for (const Skeleton::Side& side : skeleton.side)
      if (side.n > 0)
        ++part_of(side.items[0]);
    for (const auto& [part, n] : characteristic)
      ASSERT_EQ(n, 2) << material;
    unsigned left = material;
    std::size_t n_components = 0;
    for (; left != 0; ++n_components)
      left &= ~unsigned(cube::reachable(std::countr_zero(left), 0, material));
    ASSERT_EQ(characteristic.size(), n_components);
  }
}

/// A body around a cell with these nodes, its skin anywhere.
Body random_body(Random& random, const unsigned material, const Vec3& origin, const double h) {
  std::vector<Index3> nodes;
  for (int v = 0; v < 8; ++v)
    if (material >> v & 1)
      nodes.push_back({1 + (v & 1), 1 + (v >> 1 & 1), 1 + (v >> 2 & 1)});
  Body body = support::make_body({origin, h}, nodes, [&](const Grid& grid, const EdgeId e) {
    EdgeCut cut = support::midway(grid, e);
    cut.t = uniform(random, 0.01, 0.99);
    return cut;
  });
  const CellId c = *body.grid.find_cell({1, 1, 1});
  const auto anywhere = [&]() -> Vec3 { return body.grid.origin(c) + h * support::random_offset(random); };
  for (int face = 0; face < cube::n_faces; ++face) {
    Vec3 p = anywhere();
    p[face / 2] = body.grid.origin(c)[face / 2] + (face % 2 ? h : 0);
    body.cuts.set_point(body.grid.faces(c)[face], p);
  }
  body.cuts.set_point(c, anywhere());
  return body;
}

/// What the sides enclose, counted positive where they turn counter-clockwise seen from outside, in parts of h^3 [1].
double enclosed_volume(const Body& body, const CellId c) {
  const Skeleton& skeleton = skeleton_of(material_of(body.grid, c));
  const auto local = [&](const int item) -> Vec3 {
    return (item_point(body, c, item) - body.grid.origin(c)) / body.grid.h();
  };
  double six_volumes = 0;
  for (const Skeleton::Side& side : skeleton.side)
    for (int i = 2; i < side.n; ++i)
      six_volumes += local(side.items[0]).dot(local(side.items[i - 1]).cross(local(side.items[i])));
  return six_volumes / 6;
}

TEST(Skeleton, EnclosesTheMaterialOfTheOctants) {
  Random random(21);
  for (unsigned material = 1; material < 256; ++material)
    for (int k = 0; k < 10; ++k) {
      const Body body = random_body(random, material, {0.3, -2, 7}, 0.37);
      const CellId c = *body.grid.find_cell({1, 1, 1});
      ASSERT_EQ(material_of(body.grid, c), material);
      double sum = 0;
      for (int v = 0; v < 8; ++v)
        if (material >> v & 1)
          for (const Tetrahedron& t : octant(body, c, v))
            sum += volume(t);
      ASSERT_NEAR(enclosed_volume(body, c), sum, 1e-13) << material;
    }
}

TEST(Skeleton, TurnsWithTheCube) {
  const auto all = slow::symmetries();
  ASSERT_EQ(all.size(), 48u);
  EXPECT_EQ(std::ranges::count_if(all, &slow::Symmetry::is_turn), 24);
  for (const slow::Symmetry& symmetry : all)
    for (unsigned material = 0; material < 256; ++material) {
      const unsigned image = symmetry.vertices(material);
      std::set<slow::Segment> segments, segments_of_image;
      for (int s = 0; s < skeleton::n_segments; ++s) {
        if (has(skeleton_of(material).segments, s))
          segments.insert(symmetry(slow::named_segment(material, s)));
        if (has(skeleton_of(image).segments, s))
          segments_of_image.insert(slow::named_segment(image, s));
      }
      ASSERT_EQ(segments, segments_of_image);
      std::set<Row> sides, sides_of_image; // as they turn
      for (int s = 0; s < skeleton::n_sides; ++s) {
        if (has(skeleton_of(image).sides, s))
          sides_of_image.insert(named_side(image, s));
        if (!has(skeleton_of(material).sides, s))
          continue;
        Row row = named_side(material, s);
        for (Item& item : row)
          item = symmetry(item);
        sides.insert(symmetry.is_turn() ? from_lowest(row) : backwards(row));
      }
      ASSERT_EQ(sides, sides_of_image);
    }
}

/// What lies in a face has the same number seen from both of its cells.
TEST(Skeleton, IsTheSameOnBothSidesOfAFace) {
  std::size_t n_pairs = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (unsigned below = 0; below < 256; ++below)
      for (unsigned above = 0; above < 256; ++above) {
        const int upper = 2 * axis + 1, lower = 2 * axis;
        bool fits = true;
        for (int i = 0; i < 4; ++i)
          fits = fits && (below >> cube::face_vertices[upper][i] & 1) == (above >> cube::face_vertices[lower][i] & 1);
        if (!fits)
          continue;
        ++n_pairs;
        const Skeleton &s = skeleton_of(below), &t = skeleton_of(above);
        const Index3 next = slow::moved({}, axis, 1);
        for (int place = 0; place < 4; ++place) {
          const int a = skeleton::half(upper, place), b = skeleton::half(lower, place);
          ASSERT_EQ(has(s.segments, a), has(t.segments, b));
          for (const int end : {0, 1})
            if (has(s.segments, a)) {
              ASSERT_EQ(slow::named(below, s.segment[a].ends[end]), slow::named(above, t.segment[b].ends[end], next));
            }
        }
        for (int arc = 0; arc < 2; ++arc) {
          const int a = skeleton::polygon(upper, arc), b = skeleton::polygon(lower, arc);
          ASSERT_EQ(has(s.sides, a), has(t.sides, b));
          ASSERT_EQ(has(s.items, skeleton::on_arc(upper, arc)), has(t.items, skeleton::on_arc(lower, arc)));
          if (has(s.sides, a)) {
            ASSERT_EQ(named_side(below, a), backwards(named_side(above, b, next)));
          }
        }
      }
  EXPECT_EQ(n_pairs, 3u * 16 * 16 * 16);
}

} // namespace
} // namespace kerf::grid::skeleton_test
