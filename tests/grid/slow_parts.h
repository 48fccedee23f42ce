#pragma once

/// What cuts leave of faces, cells and whole bodies, from the words of grid/parts.h and with nothing of its code.
///
/// Everything is a point with twice the lattice's coordinates: nodes have even ones, of an edge's middle one is odd, of
/// a face's two, of a cell's three. So what bounds a thing is one step away, and no numbering of a cube is needed.

#include "grid/parts.h"
#include "tests/support/bodies.h"

#include <algorithm>
#include <functional>
#include <map>
#include <set>
#include <vector>

namespace kerf::grid::slow {

using Point = Index3;
using Items = std::set<Point>; ///< nodes, and rinds by their edges

/// What is asked about a body; any point may be asked for.
struct Material {
  std::function<bool(const Point& node)> is_material;
  std::function<int(const Point& edge)> n_cuts;
  std::function<Seam(const Point& face)> seam;
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

struct Arc {
  std::array<Point, 2> edges, nodes;
  std::vector<Point> inner; ///< edges between the row's nodes
};

/// Walks round a face: from each edge by which one comes into material to the one by which one leaves it.
inline std::vector<Arc> arcs(const Material& of, const Point& face) {
  constexpr std::array<std::array<int, 2>, 8> round = {
    {{-1, -1}, {0, -1}, {1, -1}, {1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}}};
  const int normal = axis_of(face);
  const auto at = [&](const int i) {
    return moved(moved(face, (normal + 1) % 3, round[i % 8][0]), (normal + 2) % 3, round[i % 8][1]);
  };
  std::vector<Arc> result;
  for (int start = 1; start < 8; start += 2) {
    if (of.is_material(at(start - 1)) || !of.is_material(at(start + 1)))
      continue;
    Arc arc;
    int end = start + 2;
    for (; of.is_material(at(end + 1)); end += 2)
      arc.inner.push_back(at(end));
    arc.edges = {at(start), at(end)};
    arc.nodes = {at(start + 1), at(end - 1)};
    result.push_back(arc);
  }
  return result;
}

inline bool is_whole(const Material& of, const Point& face, const Arc& arc) {
  if (of.seam(face) == Seam::unsaid)
    return std::ranges::all_of(arc.inner, [&](const Point& edge) { return of.n_cuts(edge) == 0; });
  return of.seam(face) == Seam::whole;
}

/// Has a blade cut one of the arc's edges, or one between its nodes?
inline bool is_beside_cut(const Material& of, const Arc& arc) {
  return of.n_cuts(arc.edges[0]) == 2 || of.n_cuts(arc.edges[1]) == 2 ||
         std::ranges::any_of(arc.inner, [&](const Point& edge) { return of.n_cuts(edge) > 0; });
}

inline bool is_item(const Material& of, const Point& p) {
  return n_odd(p) == 0 ? of.is_material(p) : n_odd(p) == 1 && of.n_cuts(p) == 2;
}

/// What an edge or a face joins.
inline std::vector<std::array<Point, 2>> joins(const Material& of, const Point& p) {
  std::vector<std::array<Point, 2>> result;
  if (n_odd(p) == 1) {
    const Point lower = moved(p, axis_of(p), -1), upper = moved(p, axis_of(p), 1);
    if (of.is_material(lower) && of.is_material(upper) && of.n_cuts(p) == 0)
      result.push_back({lower, upper});
  } else if (n_odd(p) == 2) {
    for (const Arc& arc : arcs(of, p)) {
      const auto under = [&](const int end) {
        return of.n_cuts(arc.edges[end]) == 2 ? arc.edges[end] : arc.nodes[end];
      };
      if (is_whole(of, p, arc))
        result.push_back({under(0), under(1)});
    }
  }
  return result;
}

/// The parts of a face, a cell, a body: of all that these points hold, joined by the edges and faces among them.
inline std::vector<Items> parts(const Material& of, const std::vector<Point>& points) {
  std::map<Point, std::vector<Point>> next;
  for (const Point& p : points) {
    if (is_item(of, p))
      next[p];
    for (const auto& [a, b] : joins(of, p)) {
      next[a].push_back(b);
      next[b].push_back(a);
    }
  }
  std::vector<Items> result;
  Items seen;
  for (const auto& [start, unused] : next) {
    if (!seen.insert(start).second)
      continue;
    std::vector<Point> open = {start};
    for (std::size_t i = 0; i < open.size(); ++i)
      for (const Point& p : next[open[i]])
        if (seen.insert(p).second)
          open.push_back(p);
    result.emplace_back(open.begin(), open.end());
  }
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

inline Items items_of(const Part& part, const Index3& cell) {
  Items items;
  for (int v = 0; v < 8; ++v)
    if (part.nodes >> v & 1)
      items.insert(node_point(cell, v));
  for (int line = 0; line < 12; ++line)
    if (part.rinds >> line & 1)
      items.insert(line_point(cell, line));
  return items;
}

/// One cell at the origin.
inline Material material_of(const CellCuts& cell) {
  std::map<Point, int> n_cuts;
  std::set<Point> nodes;
  std::map<Point, Seam> seams;
  for (int v = 0; v < 8; ++v)
    if (cell.material >> v & 1)
      nodes.insert(node_point({}, v));
  for (int line = 0; line < 12; ++line)
    n_cuts[line_point({}, line)] = int(cell.cut >> line & 1) + int(cell.twice >> line & 1);
  for (int face = 0; face < 6; ++face)
    seams[face_centre({}, face)] = cell.seams[face];
  return {[=](const Point& p) { return nodes.contains(p); }, [=](const Point& p) { return n_cuts.at(p); },
          [=](const Point& p) { return seams.at(p); }};
}

/// A whole body, which must outlive the result.
inline Material material_of(const support::Body& body) {
  const auto half = [](const Point& p) { return Index3{p[0] / 2, p[1] / 2, p[2] / 2}; };
  return {[&body, half](const Point& p) {
            const auto node = body.grid.find_node(half(p));
            return node && body.grid.is_material(*node);
          },
          [&body, half](const Point& p) {
            const auto edge = body.grid.find_edge(half(p), axis_of(p));
            return edge ? int(body.cuts.is_cut(*edge)) + int(body.cuts.is_cut_twice(*edge)) : 0;
          },
          [&body, half](const Point& p) {
            const int normal = axis_of(p);
            const auto above = body.grid.find_cell(half(p));
            if (above)
              return body.cuts.seam(body.grid.faces(*above)[2 * normal]);
            const auto below = body.grid.find_cell(half(moved(p, normal, -2)));
            return below ? body.cuts.seam(body.grid.faces(*below)[2 * normal + 1]) : Seam::unsaid;
          }};
}

} // namespace kerf::grid::slow
