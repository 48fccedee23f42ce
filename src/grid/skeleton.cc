#include "grid/skeleton.h"

#include <algorithm>
#include <memory>
#include <vector>

namespace kerf::grid {

namespace {

using namespace skeleton;

class Maker {
 public:
  explicit Maker(const unsigned material) : material_(material) {
    make_lines();
    number_loops();
    for (int face = 0; face < cube::n_faces; ++face)
      make_face(face);
    make_spokes();
    note_sides();
  }

  Skeleton result;

 private:
  bool is_material(const int v) const { return (material_ >> v & 1) != 0; }

  void add_item(const int item, const int vertex) {
    result.items |= Items(1) << item;
    result.vertex[item] = static_cast<std::uint8_t>(vertex);
  }
  void add_segment(const int segment, const int a, const int b) {
    result.segments |= Segments(1) << segment;
    result.segment[segment].ends = {static_cast<std::uint8_t>(a), static_cast<std::uint8_t>(b)};
  }

  void make_lines() {
    for (int v = 0; v < cube::n_vertices; ++v)
      if (is_material(v))
        add_item(v, v);
    for (int line = 0; line < cube::n_lines; ++line) {
      const auto& [v, w] = cube::line_vertices[line];
      if (is_material(v) && is_material(w))
        add_segment(line, v, w);
      else if (is_material(v) || is_material(w)) {
        const int node = is_material(v) ? v : w;
        add_item(on_line(line), node);
        add_segment(line, node, on_line(line));
      }
    }
  }

  /// Lines that arcs join have the same name: the lowest of them. Loops are numbered in that order.
  void number_loops() {
    std::array<std::uint8_t, cube::n_lines> name;
    for (std::uint8_t line = 0; line < cube::n_lines; ++line)
      name[line] = line;
    for (int face = 0; face < cube::n_faces; ++face)
      for (const SkinArc& arc : skin_arcs(face, material_))
        if (const std::uint8_t p = name[arc.lines[0]], q = name[arc.lines[1]]; p != q)
          std::replace(name.begin(), name.end(), std::max(p, q), std::min(p, q));
    for (int line = 0; line < cube::n_lines; ++line) {
      if (!(result.items >> on_line(line) & 1))
        continue;
      if (name[line] == line) {
        result.loop[line] = static_cast<std::uint8_t>(result.n_loops);
        add_item(middle(result.n_loops++), result.vertex[on_line(line)]);
      } else
        result.loop[line] = result.loop[name[line]];
    }
  }

  struct Row {
    std::vector<int> items, segments;
  };

  void add_side(const int side, const Row& row, const bool turned) {
    Skeleton::Side& of = result.side[side];
    const int n = static_cast<int>(row.items.size());
    result.sides |= Sides(1) << side;
    of.n = static_cast<std::uint8_t>(n);
    for (int i = 0; i < n; ++i) { // backwards, the segment after an item is the one before it
      of.items[i] = static_cast<std::uint8_t>(row.items[turned ? n - 1 - i : i]);
      of.segments[i] = static_cast<std::uint8_t>(row.segments[turned ? (2 * n - 2 - i) % n : i]);
    }
  }

  /// Rows of arcs turn as the sides of a face do, counter-clockwise seen along its axis' negative direction.
  void make_face(const int face) {
    const bool turned = face % 2 == 0;
    if ((material_ & cube::face_mask(face)) == cube::face_mask(face)) {
      constexpr std::array<int, 4> around = {0, 1, 3, 2};
      Row row;
      for (int i = 0; i < 4; ++i) {
        const int v = cube::face_vertices[face][around[i]], w = cube::face_vertices[face][around[(i + 1) % 4]];
        row.items.push_back(v);
        row.segments.push_back(detail::line_between(v, w));
      }
      add_side(polygon(face, 0), row, turned);
      return;
    }
    const SkinArcs& arcs = skin_arcs(face, material_);
    for (int a = 0; a < arcs.n; ++a)
      make_arc(face, a, arcs.arcs[a], turned);
  }

  void make_arc(const int face, const int a, const SkinArc& arc, const bool turned) {
    const int corner = on_arc(face, a);
    add_item(corner, arc.vertices[0]);
    const std::array halves = {half(face, cube::place_in_face(face, arc.lines[0])),
                               half(face, cube::place_in_face(face, arc.lines[1]))};
    for (const int end : {0, 1})
      add_segment(halves[end], on_line(arc.lines[end]), corner);
    Row row{{on_line(arc.lines[0])}, {arc.lines[0]}};
    for (int v = arc.vertices[0];;) {
      row.items.push_back(v);
      if (v == arc.vertices[1])
        break;
      const int next = next_in_row(v, arc, row);
      row.segments.push_back(detail::line_between(v, next));
      v = next;
    }
    row.segments.push_back(arc.lines[1]);
    row.items.push_back(on_line(arc.lines[1]));
    row.segments.push_back(halves[1]);
    row.items.push_back(corner);
    row.segments.push_back(halves[0]);
    add_side(polygon(face, a), row, turned);
    const int centre = middle(result.loop[arc.lines[0]]);
    for (const int end : {0, 1}) { // against the polygon's way along the half
      const int line = arc.lines[end];
      add_side(triangle(face, cube::place_in_face(face, line)),
               {{on_line(line), corner, centre}, {halves[end], arc_spoke(face, a), spoke(line)}}, turned == (end == 0));
    }
    add_segment(arc_spoke(face, a), corner, centre);
  }

  /// The neighbour of v along an inner line of the row that is not in it yet.
  static int next_in_row(const int v, const SkinArc& arc, const Row& row) {
    for (int w = 0; w < cube::n_vertices; ++w)
      if (const int line = detail::line_between(v, w);
          line >= 0 && (arc.inner >> line & 1) != 0 && std::ranges::find(row.items, w) == row.items.end())
        return w;
    return -1;
  }

  void make_spokes() {
    for (int line = 0; line < cube::n_lines; ++line)
      if (result.items >> on_line(line) & 1)
        add_segment(spoke(line), on_line(line), middle(result.loop[line]));
  }

  void note_sides() {
    for (int s = 0; s < n_sides; ++s) {
      const Skeleton::Side& side = result.side[s];
      for (int i = 0; i < side.n; ++i) {
        Skeleton::Segment& segment = result.segment[side.segments[i]];
        segment.sides[side.items[i] == segment.ends[0] ? 0 : 1] = static_cast<std::uint8_t>(s);
      }
    }
  }

  unsigned material_;
};

} // namespace

Items Skeleton::reachable(const Items from, const Segments cut) const {
  Items reached = from, before = 0;
  while (reached != before) {
    before = reached;
    for (Segments left = segments & ~cut; left != 0; left &= left - 1) {
      const auto& [a, b] = segment[std::countr_zero(left)].ends;
      const Items ends = Items(1) << a | Items(1) << b;
      if ((reached & ends) != 0)
        reached |= ends;
    }
  }
  return reached;
}

Items Skeleton::reachable_within(const int of_side, const int from, const Segments cut) const {
  const auto& [n, around, between] = side[of_side];
  Items reached = Items(1) << from, before = 0;
  while (reached != before) {
    before = reached;
    for (int i = 0; i < n; ++i) {
      const Items ends = Items(1) << around[i] | Items(1) << around[(i + 1) % n];
      if ((cut >> between[i] & 1) == 0 && (reached & ends) != 0)
        reached |= ends;
    }
  }
  return reached;
}

const Skeleton& skeleton_of(const unsigned material) {
  static const auto all = [] {
    auto made = std::make_unique<std::array<Skeleton, 256>>();
    for (unsigned m = 0; m < 256; ++m)
      (*made)[m] = Maker(m).result;
    return made;
  }();
  return (*all)[material];
}

} // namespace kerf::grid
