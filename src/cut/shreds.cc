#include "cut/shreds.h"

#include "grid/material.h"
#include "grid/touched.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <map>
#include <optional>
#include <set>

namespace kerf::cut {

namespace {

namespace cube = grid::cube;
namespace skeleton = grid::skeleton;
using grid::CellId;
using grid::EdgeId;
using grid::Items;
using grid::SkinSegment;

constexpr double no_volume = 1e-9;                     // of a cube
constexpr double thin = 0.1;                           // of a cube's edge
constexpr std::size_t most_nodes = 8, most_cells = 64; // of a shred

/// Nodes and points of the skin that hang together, and with nothing else.
struct Shred {
  std::map<CellId, Items> items;
  std::set<grid::NodeId> nodes;
};

/// A blade's cut of a segment from the shred to something else.
struct Bound {
  EdgeId edge; ///< invalid for a segment of the skin
  SkinSegment segment;
  Vec3 point, normal; ///< [m], rest frame
  grid::CutLabel label;
  double distance; ///< from the segment's end in the shred [m]
};

/// What of a body's new cuts is not in its complex yet.
struct NewCuts {
  std::vector<EdgeId>& edges;
  std::vector<SkinSegment>& segments;

  bool holds(const Bound& bound) const {
    return bound.edge.valid() ? std::ranges::binary_search(edges, bound.edge)
                              : std::ranges::binary_search(segments, bound.segment);
  }
};

struct TakenBack {
  std::vector<EdgeId> edges;
  std::vector<SkinSegment> segments;

  void add(const Bound& bound) {
    if (bound.edge.valid())
      edges.push_back(bound.edge);
    else
      segments.push_back(bound.segment);
  }
};

/// The cells that know an item of a cell, and which item of theirs it is.
template <class Function>
void for_each_sharing(const grid::Grid& grid, const CellId c, const int item, const Function& f) {
  if (item >= skeleton::first_middle)
    return;
  if (item >= skeleton::first_on_arc) {
    const int face = (item - skeleton::first_on_arc) / 2, arc = (item - skeleton::first_on_arc) % 2;
    if (const CellId other = grid.neighbour(c, face); other.valid())
      f(other, skeleton::on_arc(face ^ 1, arc));
    return;
  }
  if (item >= skeleton::first_on_line) {
    const EdgeId edge = grid.edges(c)[item - skeleton::first_on_line];
    for (const CellId other : grid.cells(edge))
      if (other.valid() && other != c) {
        const auto edges = grid.edges(other);
        f(other, skeleton::on_line(static_cast<int>(std::find(edges.begin(), edges.end(), edge) - edges.begin())));
      }
    return;
  }
  for (int axis = 0; axis < 3; ++axis) // those cells reach the others around the node
    f(grid.neighbour(c, 2 * axis + (item >> axis & 1)), item ^ 1 << axis);
}

/// All that hangs together with an item of a cell; nothing where that is more than a shred.
std::optional<Shred> shred_at(const grid::Solid& solid, const CellId cell, const int item) {
  Shred shred;
  std::vector<std::pair<CellId, int>> open = {{cell, item}};
  while (!open.empty()) {
    const auto [c, i] = open.back();
    open.pop_back();
    Items& known = shred.items[c];
    if (known >> i & 1)
      continue;
    const grid::CellCuts cuts = grid::cuts_of(solid, c);
    const Items found = cuts.skeleton().reachable(Items(1) << i, cuts.blades);
    known |= found;
    const auto nodes = solid.grid.nodes(c);
    for (int v = 0; v < cube::n_vertices; ++v)
      if (found >> v & 1)
        shred.nodes.insert(nodes[v]);
    if (shred.nodes.size() > most_nodes || shred.items.size() > most_cells)
      return std::nullopt;
    for (Items left = found; left != 0; left &= left - 1)
      for_each_sharing(solid.grid, c, std::countr_zero(left),
                       [&](const CellId other, const int its) { open.emplace_back(other, its); });
  }
  return shred;
}

Bound bound_at(const grid::Solid& solid, const CellId c, const grid::CellCuts& cuts, const int segment,
               const int inner_end) {
  const Vec3 point = grid::segment_point(solid, c, cuts.skeleton(), segment);
  const double distance = (point - grid::item_point(solid, c, inner_end)).norm();
  if (segment < cube::n_lines) {
    const EdgeId edge = solid.grid.edges(c)[segment];
    const grid::EdgeCut& cut = *solid.cuts.find(edge);
    return {edge, {}, point, cut.normal, cut.label, distance};
  }
  const SkinSegment of_skin = grid::skin_segment(solid.grid, c, segment);
  const grid::SkinCut& cut = *solid.cuts.find(of_skin);
  return {EdgeId(), of_skin, point, cut.normal, cut.label, distance};
}

/// What the cells share comes once from each.
std::vector<Bound> bounds_of(const grid::Solid& solid, const Shred& shred) {
  std::vector<Bound> bounds;
  for (const auto& [c, items] : shred.items) {
    const grid::CellCuts cuts = grid::cuts_of(solid, c);
    for (grid::Segments left = cuts.blades; left != 0; left &= left - 1) {
      const int segment = std::countr_zero(left);
      const auto& [a, b] = cuts.skeleton().segment[segment].ends;
      if (((items >> a ^ items >> b) & 1) != 0)
        bounds.push_back(bound_at(solid, c, cuts, segment, items >> a & 1 ? a : b));
    }
  }
  return bounds;
}

/// Of a cube [1].
double volume(const grid::Solid& solid, const Shred& shred) {
  double sum = 0;
  for (const auto& [c, items] : shred.items)
    for (const auto& [t, vertex] : grid::pieces_of(solid, c, items))
      sum += grid::volume(t);
  return sum;
}

Points nodes_or_points_of_skin(const grid::Solid& solid, const Shred& shred) {
  Points points;
  for (const grid::NodeId node : shred.nodes)
    points.push_back(solid.grid.position(node));
  if (points.empty())
    for (const auto& [c, items] : shred.items)
      for (Items left = items; left != 0; left &= left - 1)
        points.push_back(grid::item_point(solid, c, std::countr_zero(left)));
  return points;
}

/// Do all cuts, of one blade, lie within a thin slice along the normal of one of them, with the shred in between?
bool is_shaving(const grid::Solid& solid, const Shred& shred, const std::vector<Bound>& bounds) {
  if (std::ranges::any_of(bounds, [&](const Bound& bound) { return bound.label != bounds.front().label; }))
    return false;
  const Points points = nodes_or_points_of_skin(solid, shred);
  return std::ranges::any_of(bounds, [&](const Bound& one) {
    double lower = std::numeric_limits<double>::infinity(), upper = -lower;
    for (const Bound& bound : bounds) {
      lower = std::min(lower, one.normal.dot(bound.point));
      upper = std::max(upper, one.normal.dot(bound.point));
    }
    return upper - lower < thin * solid.grid.h() && std::ranges::all_of(points, [&](const Vec3& p) {
             const double height = one.normal.dot(p);
             return lower < height && height < upper;
           });
  });
}

/// Of a tip all new cuts of the blade that comes nearest: it may hang on both sides of another one.
void leave(const grid::Solid& solid, const Shred& shred, const NewCuts& new_cuts, TakenBack& back) {
  const std::vector<Bound> bounds = bounds_of(solid, shred);
  const bool is_tip = shred.nodes.empty() && volume(solid, shred) <= no_volume;
  if (!is_tip && !is_shaving(solid, shred, bounds))
    return;
  const Bound* nearest = nullptr;
  for (const Bound& bound : bounds)
    if (new_cuts.holds(bound) && (!nearest || bound.distance < nearest->distance))
      nearest = &bound;
  if (!nearest)
    return;
  for (const Bound& bound : bounds)
    if (&bound == nearest || (is_tip && bound.label == nearest->label && new_cuts.holds(bound)))
      back.add(bound);
}

template <class Key>
std::size_t take_back(grid::Cuts& cuts, std::vector<Key>& from, std::vector<Key>& back) {
  std::sort(back.begin(), back.end());
  back.erase(std::unique(back.begin(), back.end()), back.end());
  if (!back.empty()) {
    cuts.take_back(back);
    std::erase_if(from, [&](const Key& key) { return std::ranges::binary_search(back, key); });
  }
  return back.size();
}

} // namespace

std::size_t leave_shreds(grid::Solid& solid, std::vector<EdgeId>& edges, std::vector<SkinSegment>& segments) {
  const NewCuts new_cuts{edges, segments};
  TakenBack back;
  std::map<CellId, Items> seen; // of shreds
  for (const CellId c : grid::touched_cells(solid.grid, edges, segments))
    for (const grid::Part& part : whole_parts_of(grid::cuts_of(solid, c))) {
      const int item = std::countr_zero(part.items());
      if (const auto known = seen.find(c); known != seen.end() && (known->second >> item & 1) != 0)
        continue;
      if (const auto shred = shred_at(solid, c, item)) {
        for (const auto& [cell, items] : shred->items)
          seen[cell] |= items;
        leave(solid, *shred, new_cuts, back);
      }
    }
  return take_back(solid.cuts, edges, back.edges) + take_back(solid.cuts, segments, back.segments);
}

} // namespace kerf::cut
