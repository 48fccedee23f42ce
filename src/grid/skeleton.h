#pragma once

/// A cell's material as a polyhedron: what blades find of it, and what they leave of it. The thesis asks for cut edges
/// of the grid alone (§2.3.3), and so cannot know what a blade does to the skin between them.
///
/// Its vertices are the material nodes and, where the skin passes through the cell, those of the skin: one on each edge
/// of the skin, one for each arc of the skin in a face (skin_arcs.h), one in the middle of each closed row of arcs. Its
/// segments, each of which a blade may cut, join two of them: edges of the grid between material nodes, and from a node
/// to the skin; halves of arcs in faces; spokes from the middle to the other two in the cell. Its sides are bounded by
/// segments: a polygon a face, or an arc of it, and the triangles of the skin.
///
/// Everything is numbered within the cell, so that the numbers are bits of masks:
///   items      0 .. 7 nodes, 8 .. 19 on lines, 20 .. 31 on arcs (two a face), 32 .. 35 middles
///   segments   0 .. 11 lines, 12 .. 35 halves of arcs (four a face, by the place of their line: cube::face_lines),
///              36 .. 47 spokes to lines, 48 .. 59 spokes to arcs
///   intervals  0 .. 23 of lines (two a line), 24 .. 47 of halves: what of them lies between two cuts that meet them,
///              counted from the segment's first end
///   sides      0 .. 11 polygons (two a face, by arc), 12 .. 35 triangles, by the half of an arc that bounds them

#include "grid/cube.h"
#include "grid/skin_arcs.h"

#include <array>
#include <cstdint>

namespace kerf::grid {

/// Sets of items, of intervals, of segments, of sides.
using Items = std::uint64_t;
using Intervals = std::uint64_t;
using Segments = std::uint64_t;
using Sides = std::uint64_t;

namespace skeleton {

constexpr int n_items = 36, n_segments = 60, n_sides = 36, max_loops = 4;
constexpr int first_on_line = 8, first_on_arc = 20, first_middle = 32;
constexpr int first_half = 12, first_spoke = 36, first_arc_spoke = 48;
constexpr int first_triangle = 12;

constexpr int on_line(const int line) { return first_on_line + line; }
constexpr int on_arc(const int face, const int arc) { return first_on_arc + 2 * face + arc; }
constexpr int middle(const int loop) { return first_middle + loop; }
constexpr int half(const int face, const int place) { return first_half + 4 * face + place; }
constexpr int spoke(const int line) { return first_spoke + line; }
constexpr int arc_spoke(const int face, const int arc) { return first_arc_spoke + 2 * face + arc; }
constexpr int polygon(const int face, const int arc) { return 2 * face + arc; }
constexpr int triangle(const int face, const int place) { return first_triangle + 4 * face + place; }

/// All of a segment that lies in a face.
constexpr Intervals intervals_of(const int segment) {
  return segment < first_half ? Intervals(3) << 2 * segment : Intervals(1) << (first_half + segment);
}
/// The segments of a face, in the same order in both of its cells: four lines, four halves.
constexpr int in_face(const int face, const int i) { return i < 4 ? cube::face_lines[face][i] : half(face, i - 4); }

constexpr Segments lines = 0xfff;
constexpr Segments spokes = ~Segments(0) << first_spoke & ~Segments(0) >> (64 - n_segments);

} // namespace skeleton

struct Skeleton {
  struct Segment {
    std::array<std::uint8_t, 2> ends{};  ///< items; of a line of the skin its node first, of a spoke its middle last
    std::array<std::uint8_t, 2> sides{}; ///< whose border passes from the first end to the second, and back
  };
  /// Its border, counter-clockwise seen from outside of the cell: segments[i] joins items[i] and the next one.
  struct Side {
    std::uint8_t n = 0;
    std::array<std::uint8_t, 6> items{}, segments{};
  };

  Items items = 0;
  Segments segments = 0;
  Sides sides = 0;
  std::array<Segment, skeleton::n_segments> segment{};
  std::array<Side, skeleton::n_sides> side{};
  std::array<std::uint8_t, skeleton::n_items>
    vertex{};                                     ///< of each item the vertex of the cube whose material it bounds
  std::array<std::uint8_t, cube::n_lines> loop{}; ///< of each line of the skin: the row of arcs through it
  int n_loops = 0;

  /// The items that can be reached from some without crossing a cut segment.
  Items reachable(Items from, Segments cut) const;
  /// Those of a side that can be reached from one of them along its border.
  Items reachable_within(int of_side, int from, Segments cut) const;
};

/// Of a cell with these material vertices (8 bits).
const Skeleton& skeleton_of(unsigned material);

} // namespace kerf::grid
