#pragma once

/// What cuts leave of cells and whole bodies, from the words of grid/skeleton.h and grid/parts.h and with nothing of
/// their code.
///
/// Everything is a point with twice the lattice's coordinates: nodes have even ones, of an edge's middle one is odd, of
/// a face's two, of a cell's three. So what bounds a thing is one step away, and no numbering of a cube is needed.

#include "grid/parts.h"
#include "tests/support/bodies.h"

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <set>
#include <stdexcept>
#include <vector>

namespace kerf::grid::slow {

using Point = Index3;

/// A node; a point of the skin on an edge, by that; the corner of an arc, by its face and the arc's nodes; the middle
/// of a row of arcs, by its cell and the row's edges.
struct Item {
  Point at{};
  std::set<Point> of = {};

  auto operator<=>(const Item&) const = default;
};
using Items = std::set<Item>;

using Segment = std::set<Item>; ///< its two ends

/// What is asked about a body; any point may be asked for.
struct Material {
  std::function<bool(const Point& node)> is_material;
  std::set<Segment> cut; ///< by blades
};

inline int n_odd(const Point& p) { return (p[0] & 1) + (p[1] & 1) + (p[2] & 1); }

inline Point moved(Point p, const int axis, const int step) {
  p[axis] += step;
  return p;
}

/// The axis of an edge, of a face's normal: the one whose coordinate is unlike the other two.
inline int axis_of(const Point& p) {
  const int unlike = n_odd(p) == 1 ? 1 : 0;
  return (p[0] & 1) == unlike ? 0 : (p[1] & 1) == unlike ? 1 : 2;
}

/// All points of a box, both corners included.
inline std::vector<Point> box(const Point& lower, const Point& upper) {
  std::vector<Point> points;
  for (int i = lower[0]; i <= upper[0]; ++i)
    for (int j = lower[1]; j <= upper[1]; ++j)
      for (int k = lower[2]; k <= upper[2]; ++k)
        points.push_back({i, j, k});
  return points;
}

/// An edge, a face or a cell, with all that bounds it.
inline std::vector<Point> closure(const Point& p) {
  Point lower = p, upper = p;
  for (int axis = 0; axis < 3; ++axis)
    if (p[axis] & 1) {
      --lower[axis];
      ++upper[axis];
    }
  return box(lower, upper);
}

/// From edge to edge of a face, over a row of nodes.
struct Arc {
  Point face;
  std::array<Point, 2> edges;
  std::vector<Point> nodes, inner; ///< of the row, and the edges between them, in the order of the walk

  Item corner() const { return {face, {nodes.begin(), nodes.end()}}; }
  bool has(const Point& edge) const { return edges[0] == edge || edges[1] == edge; }
};

/// The place of a walker round a face after i steps: even ones are nodes.
inline Point around(const Point& face, const int i) {
  constexpr std::array<std::array<int, 2>, 8> round = {
    {{-1, -1}, {0, -1}, {1, -1}, {1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}}};
  const int normal = axis_of(face);
  return moved(moved(face, (normal + 1) % 3, round[i % 8][0]), (normal + 2) % 3, round[i % 8][1]);
}

/// Walks round a face: from each edge by which one comes into material to the one by which one leaves it.
inline std::vector<Arc> arcs(const Material& of, const Point& face) {
  std::vector<Arc> result;
  for (int start = 1; start < 8; start += 2) {
    if (of.is_material(around(face, start - 1)) || !of.is_material(around(face, start + 1)))
      continue;
    Arc arc{face, {}, {around(face, start + 1)}, {}};
    int end = start + 2;
    for (; of.is_material(around(face, end + 1)); end += 2) {
      arc.inner.push_back(around(face, end));
      arc.nodes.push_back(around(face, end + 1));
    }
    arc.edges = {around(face, start), around(face, end)};
    result.push_back(arc);
  }
  return result;
}

inline std::vector<Arc> arcs_of_cell(const Material& of, const Point& cell) {
  std::vector<Arc> all;
  for (const Point& p : closure(cell))
    if (n_odd(p) == 2)
      for (const Arc& arc : arcs(of, p))
        all.push_back(arc);
  return all;
}

using Loop = std::vector<Arc>;

inline Item middle(const Point& cell, const Loop& loop) {
  Item result{cell};
  for (const Arc& arc : loop)
    result.of.insert(arc.edges.begin(), arc.edges.end());
  return result;
}

/// Walks over the skin of a cell: from an arc over an edge at its end to the other arc there, until it is back.
inline std::vector<Loop> loops(const Material& of, const Point& cell) {
  std::vector<Arc> left = arcs_of_cell(of, cell);
  std::vector<Loop> result;
  while (!left.empty()) {
    Loop loop = {left.back()};
    left.pop_back();
    for (Point end = loop[0].edges[1]; end != loop[0].edges[0];) {
      const auto next = std::ranges::find_if(left, [&](const Arc& arc) { return arc.has(end); });
      if (next == left.end())
        throw std::logic_error("a row of arcs has an end");
      end = next->edges[next->edges[0] == end ? 1 : 0];
      loop.push_back(*next);
      left.erase(next);
    }
    result.push_back(loop);
  }
  return result;
}

/// The segments right on an edge, in a face, in a cell; not those of its border.
inline std::vector<Segment> own_segments(const Material& of, const Point& p) {
  std::vector<Segment> result;
  if (n_odd(p) == 1) {
    const Point lower = moved(p, axis_of(p), -1), upper = moved(p, axis_of(p), 1);
    const bool has_lower = of.is_material(lower), has_upper = of.is_material(upper);
    if (has_lower || has_upper)
      result.push_back({Item{has_lower ? lower : p}, Item{has_upper ? upper : p}});
  } else if (n_odd(p) == 2) {
    for (const Arc& arc : arcs(of, p))
      for (const Point& edge : arc.edges)
        result.push_back({Item{edge}, arc.corner()});
  } else if (n_odd(p) == 3) {
    for (const Loop& loop : loops(of, p))
      for (const Arc& arc : loop) {
        result.push_back({arc.corner(), middle(p, loop)});
        result.push_back({Item{arc.edges[0]}, middle(p, loop)});
        result.push_back({Item{arc.edges[1]}, middle(p, loop)});
      }
  }
  return result;
}

inline std::set<Segment> segments(const Material& of, const std::vector<Point>& points) {
  std::set<Segment> result;
  for (const Point& p : points)
    for (const Segment& s : own_segments(of, p))
      result.insert(s);
  return result;
}

/// Closed rows of items round the sides of a cell, from anywhere on and either way.
inline std::vector<std::vector<Item>> sides(const Material& of, const Point& cell) {
  std::vector<std::vector<Item>> result;
  for (const Point& face : closure(cell)) {
    if (n_odd(face) != 2)
      continue;
    std::vector<Item> whole;
    for (int i = 0; i < 8; i += 2)
      if (of.is_material(around(face, i)))
        whole.push_back({around(face, i)});
    if (whole.size() == 4)
      result.push_back(whole);
  }
  for (const Loop& loop : loops(of, cell))
    for (const Arc& arc : loop) {
      std::vector<Item> polygon = {Item{arc.edges[0]}};
      for (const Point& node : arc.nodes)
        polygon.push_back({node});
      polygon.push_back({arc.edges[1]});
      polygon.push_back(arc.corner());
      result.push_back(polygon);
      for (const Point& edge : arc.edges)
        result.push_back({Item{edge}, arc.corner(), middle(cell, loop)});
    }
  return result;
}

/// The parts of a cell, of a body: of all that these points hold, joined by the segments that are not cut.
inline std::vector<Items> parts(const Material& of, const std::vector<Point>& points) {
  std::map<Item, std::vector<Item>> next;
  for (const Point& p : points)
    if (n_odd(p) == 0 && of.is_material(p))
      next[{p}];
  for (const Segment& segment : segments(of, points)) {
    const Item &a = *segment.begin(), &b = *segment.rbegin();
    next[a];
    next[b];
    if (of.cut.contains(segment))
      continue;
    next[a].push_back(b);
    next[b].push_back(a);
  }
  std::vector<Items> result;
  Items seen;
  for (const auto& [start, unused] : next) {
    if (!seen.insert(start).second)
      continue;
    std::vector<Item> open = {start};
    for (std::size_t i = 0; i < open.size(); ++i)
      for (const Item& item : std::vector<Item>(next[open[i]]))
        if (seen.insert(item).second)
          open.push_back(item);
    result.emplace_back(open.begin(), open.end());
  }
  return result;
}

inline bool has_skin(const Material& of, const Point& cell) { return !arcs_of_cell(of, cell).empty(); }

/// Have blades cut something of a cell where the skin passes through?
inline bool is_cut_at_skin(const Material& of, const Point& cell) {
  const auto all = segments(of, closure(cell));
  return has_skin(of, cell) && std::ranges::any_of(all, [&](const Segment& s) { return of.cut.contains(s); });
}

inline Items nodes_of(const Items& items) {
  Items nodes;
  for (const Item& item : items)
    if (n_odd(item.at) == 0)
      nodes.insert(item);
  return nodes;
}

/// What is said of the parts of a cell: their nodes, and only where blades have cut at the skin its points too.
inline std::set<Items> said_parts(const Material& of, const Point& cell) {
  const bool with_skin = is_cut_at_skin(of, cell);
  std::set<Items> result;
  for (const Items& items : parts(of, closure(cell)))
    result.insert(with_skin ? items : nodes_of(items));
  return result;
}

/// Points of the cell whose lowest node has these lattice coordinates.
inline Point node_point(const Index3& cell, const int v) {
  return {2 * cell[0] + 2 * (v & 1), 2 * cell[1] + 2 * (v >> 1 & 1), 2 * cell[2] + 2 * (v >> 2 & 1)};
}
inline Point line_point(const Index3& cell, const int line) {
  const Point p = node_point(cell, cube::line_vertices[line][0]), q = node_point(cell, cube::line_vertices[line][1]);
  return {(p[0] + q[0]) / 2, (p[1] + q[1]) / 2, (p[2] + q[2]) / 2};
}
inline Point cell_centre(const Index3& cell) { return {2 * cell[0] + 1, 2 * cell[1] + 1, 2 * cell[2] + 1}; }
inline Point face_centre(const Index3& cell, const int face) {
  return moved(cell_centre(cell), face / 2, face % 2 ? 1 : -1);
}

/// What the numbers of a cell's items stand for (tests/grid/skeleton_test.cc: these are all, and no others).
inline Item named(const unsigned material, const int item, const Index3& cell = {}) {
  if (item < skeleton::first_on_line)
    return {node_point(cell, item)};
  if (item < skeleton::first_on_arc)
    return {line_point(cell, item - skeleton::first_on_line)};
  if (item < skeleton::first_middle) {
    const int face = (item - skeleton::first_on_arc) / 2;
    const SkinArc& arc = skin_arcs(face, material).arcs[item % 2];
    Item result{face_centre(cell, face)};
    for (const int v : arc.vertices)
      result.of.insert(node_point(cell, v));
    for (int line = 0; line < cube::n_lines; ++line)
      if (arc.inner >> line & 1)
        for (const int v : cube::line_vertices[line])
          result.of.insert(node_point(cell, v));
    return result;
  }
  const Skeleton& skeleton = skeleton_of(material);
  Item result{cell_centre(cell)};
  for (int line = 0; line < cube::n_lines; ++line)
    if ((skeleton.items >> skeleton::on_line(line) & 1) != 0 && skeleton.loop[line] == item - skeleton::first_middle)
      result.of.insert(line_point(cell, line));
  return result;
}

inline Items named(const unsigned material, const Part& part, const Index3& cell = {}) {
  Items items;
  for (int i = 0; i < skeleton::n_items; ++i)
    if (part.items() >> i & 1)
      items.insert(named(material, i, cell));
  return items;
}

inline Segment named_segment(const unsigned material, const int segment, const Index3& cell = {}) {
  const auto& [a, b] = skeleton_of(material).segment[segment].ends;
  return {named(material, a, cell), named(material, b, cell)};
}

/// One cell at the origin.
inline Material material_of(const CellCuts& cell) {
  std::set<Point> nodes;
  for (int v = 0; v < 8; ++v)
    if (cell.material >> v & 1)
      nodes.insert(node_point({}, v));
  Material result{[nodes](const Point& p) { return nodes.contains(p); }, {}};
  for (int s = 0; s < skeleton::n_segments; ++s)
    if (cell.blades >> s & 1)
      result.cut.insert(named_segment(cell.material, s));
  return result;
}

inline Index3 lattice_cell(const Grid& grid, const CellId c) { return grid.index(grid.nodes(c)[0]); }

/// The segment of the skin that a cut names, by the walks.
inline Segment walked(const Material& of, const Grid& grid, const SkinSegment& segment) {
  if (segment.face.valid()) {
    const auto& [below, above] = grid.cells(segment.face);
    const CellId c = below.valid() ? below : above;
    const auto faces = grid.faces(c);
    const int face = static_cast<int>(std::ranges::find(faces, segment.face) - faces.begin());
    const Point edge = line_point(lattice_cell(grid, c), cube::face_lines[face][segment.place]);
    for (const Arc& arc : arcs(of, face_centre(lattice_cell(grid, c), face)))
      if (arc.has(edge))
        return {Item{edge}, arc.corner()};
    throw std::logic_error("a half of no arc");
  }
  const Index3 cell = lattice_cell(grid, segment.cell);
  const int place = segment.place;
  const Item end = place < cube::n_lines ? Item{line_point(cell, place)}
                                         : named(grid::material_of(grid, segment.cell),
                                                 skeleton::first_on_arc + place - cube::n_lines, cell);
  for (const Loop& loop : loops(of, cell_centre(cell)))
    for (const Arc& arc : loop)
      if (arc.corner() == end || arc.has(end.at))
        return {end, middle(cell_centre(cell), loop)};
  throw std::logic_error("a spoke of no loop");
}

/// A whole body, which must outlive the result.
inline Material material_of(const support::Body& body) {
  const Grid& grid = body.grid;
  Material result{[&grid](const Point& p) {
                    const auto node = grid.find_node({p[0] / 2, p[1] / 2, p[2] / 2});
                    return node && grid.is_material(*node);
                  },
                  {}};
  for (const EdgeCut& cut : body.cuts.all())
    if (cut.label != skin_label) {
      const Index3 lower = grid.index(grid.ends(cut.edge)[0]);
      const Point p = moved({2 * lower[0], 2 * lower[1], 2 * lower[2]}, grid.axis(cut.edge), 1);
      for (const Segment& segment : own_segments(result, p))
        result.cut.insert(segment);
    }
  for (const SkinCut& cut : body.cuts.skin_cuts())
    result.cut.insert(walked(result, grid, cut.segment));
  return result;
}

} // namespace kerf::grid::slow
