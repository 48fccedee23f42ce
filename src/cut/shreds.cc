#include "cut/shreds.h"

#include "base/sort_unique.h"
#include "cut/dents.h"
#include "cut/sides.h"
#include "grid/material.h"
#include "grid/touched.h"

#include <algorithm>
#include <bit>
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

constexpr double of_tip = 1e-3, little = 1;              // of a cube
constexpr std::size_t most_nodes = 16, most_cells = 128; // of a shred

using ItemsOfCells = std::map<CellId, Items>;
using ItemsOfFewCells = std::vector<std::pair<CellId, Items>>; // searched from the end

/// Nodes and points of the skin that hang together, and with nothing else.
struct Shred {
  ItemsOfFewCells items; // ascending
  std::vector<grid::NodeId> nodes;
};

/// A blade's cut of a segment from the shred to something else.
struct Bound {
  EdgeId edge; ///< invalid for a segment of the skin
  SkinSegment segment;
  Vec3 outward; ///< the cut's normal, away from the shred
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

/// Calls f(other, its items) for cells that know some of the items of a cell; nodes are told to those across faces, which
/// reach the others around them.
template <class Function>
void for_each_sharing(const grid::Grid& grid, const CellId c, const Items items, const Function& f) {
  for (int face = 0; face < cube::n_faces; ++face) {
    const Items nodes = items & cube::face_mask(face);
    Items across = face % 2 == 1 ? nodes >> (1 << face / 2) : nodes << (1 << face / 2);
    for (const int arc : {0, 1})
      if ((items >> skeleton::on_arc(face, arc) & 1) != 0)
        across |= Items(1) << skeleton::on_arc(face ^ 1, arc);
    if (across != 0)
      if (const CellId other = grid.neighbour(c, face); other.valid())
        f(other, across);
  }
  constexpr Items lines = (Items(1) << cube::n_lines) - 1;
  for (Items left = items >> skeleton::first_on_line & lines; left != 0; left &= left - 1) {
    const EdgeId edge = grid.edges(c)[std::countr_zero(left)];
    for (const CellId other : grid.cells(edge))
      if (other.valid() && other != c)
        f(other, Items(1) << skeleton::on_line(grid.line(other, edge)));
  }
}

Items& of_cell(ItemsOfFewCells& all, const CellId c) {
  const auto known = std::find_if(all.rbegin(), all.rend(), [&](const auto& items) { return items.first == c; });
  return known != all.rend() ? known->second : all.emplace_back(c, 0).second;
}

void add(ItemsOfCells& all, const ItemsOfFewCells& more) {
  for (const auto& [cell, items] : more)
    all[cell] |= items;
}
bool holds(const ItemsOfCells& all, const CellId cell, const Items items) {
  const auto known = all.find(cell);
  return known != all.end() && (known->second & items) != 0;
}

/// All that hangs together with an item of a cell; nothing where that is more than a shred, which joins `large`.
std::optional<Shred> shred_at(const grid::Solid& solid, const CellId cell, const int item, ItemsOfCells& large,
                              const CutsOfCell& cuts_of) {
  Shred shred;
  shred.items.reserve(16);
  shred.nodes.reserve(most_nodes + cube::n_vertices);
  ItemsOfFewCells open = {{cell, Items(1) << item}};
  while (!open.empty()) {
    const auto [c, items] = open.back();
    open.pop_back();
    Items& known = of_cell(shred.items, c);
    if ((items & ~known) == 0)
      continue;
    const grid::CellCuts cuts = cuts_of(c);
    const Items found = cuts.skeleton().reachable(items, cuts.blades);
    known |= found;
    const auto nodes = solid.grid.nodes(c);
    for (int v = 0; v < cube::n_vertices; ++v)
      if ((found >> v & 1) != 0 && std::ranges::find(shred.nodes, nodes[v]) == shred.nodes.end())
        shred.nodes.push_back(nodes[v]);
    const bool is_whole_cube = cuts.material == 0xff && cuts.cut == 0;
    if (is_whole_cube || shred.nodes.size() > most_nodes || shred.items.size() > most_cells || holds(large, c, found)) {
      add(large, shred.items);
      return std::nullopt;
    }
    for_each_sharing(solid.grid, c, found,
                     [&](const CellId other, const Items its) { open.emplace_back(other, its); });
  }
  std::ranges::sort(shred.items);
  return shred;
}

Bound bound_at(const grid::Solid& solid, const CellId c, const grid::CellCuts& cuts, const int segment,
               const int inner_end) {
  const Vec3 to_cut = grid::segment_point(solid, c, cuts.skeleton(), segment) - grid::item_point(solid, c, inner_end);
  const auto outward = [&](const Vec3& normal) -> Vec3 { return normal.dot(to_cut) < 0 ? Vec3(-normal) : normal; };
  if (segment < cube::n_lines) {
    const EdgeId edge = solid.grid.edges(c)[segment];
    const grid::EdgeCut& cut = *solid.cuts.find(edge);
    return {edge, {}, outward(cut.normal), cut.label, to_cut.norm()};
  }
  const SkinSegment of_skin = grid::skin_segment(solid.grid, c, segment);
  const grid::SkinCut& cut = *solid.cuts.find(of_skin);
  return {EdgeId(), of_skin, outward(cut.normal), cut.label, to_cut.norm()};
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

/// Do cuts of one blade bound the shred, and on opposite sides?
bool is_between_passes(const std::vector<Bound>& bounds) {
  constexpr double opposite = -0.5;
  return std::ranges::all_of(bounds, [&](const Bound& a) { return a.label == bounds.front().label; }) &&
         std::ranges::any_of(bounds, [&](const Bound& a) {
           return std::ranges::any_of(bounds, [&](const Bound& b) { return a.outward.dot(b.outward) < opposite; });
         });
}

/// Of a tip all new cuts of the blade that comes nearest: it may hang on both sides of another one.
void leave(const grid::Solid& solid, const Shred& shred, const NewCuts& new_cuts, TakenBack& back) {
  const std::vector<Bound> bounds = bounds_of(solid, shred);
  const double material = volume(solid, shred);
  const bool is_tip = shred.nodes.empty() && material <= of_tip;
  if (!is_tip && !(material < little && is_between_passes(bounds)))
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

void cut(grid::Solid& solid, const EdgeId e, const grid::LaterCut& by) {
  solid.cuts.add(solid.grid, {e, by.t, by.normal, by.label});
}
void cut(grid::Solid& solid, const SkinSegment& segment, const grid::LaterCut& by) {
  solid.cuts.add({segment, by.t, by.normal, by.label});
}

/// Whose cuts of what were taken back already.
template <class Key>
using Taken = std::set<std::pair<Key, grid::CutLabel>>;

/// What another blade has met, too, is cut by that one then: it parts the shred from what is beyond both.
template <class Key>
std::size_t take_back(grid::Solid& solid, std::vector<Key>& from, std::vector<Key>& back, Taken<Key>& taken) {
  sort_unique(back);
  if (back.empty())
    return 0;
  for (const Key& key : back)
    taken.emplace(key, solid.cuts.find(key)->label);
  solid.cuts.leave_whole(back);
  std::set<Key> whole;
  for (const Key& key : back) {
    const auto met = solid.cuts.later_cuts(key);
    const auto next = std::ranges::find_if(
      met, [&](const grid::LaterCut& one) { return !taken.contains({key, one.label}); });
    if (next == met.end())
      whole.insert(key);
    else
      cut(solid, key, grid::LaterCut(*next));
  }
  std::erase_if(from, [&](const Key& key) { return whole.contains(key); });
  return back.size();
}

/// Does something else in the cells beside this one hold intervals of it?
bool is_held_across_faces(const grid::Solid& solid, const Shred& shred, const CellId c,
                          const grid::Intervals intervals) {
  const grid::Part mine{0, 0, intervals};
  for (int face = 0; face < cube::n_faces && intervals != 0; ++face) {
    const CellId next = solid.grid.neighbour(c, face);
    if (!next.valid())
      continue;
    const auto known = std::ranges::find(shred.items, next, &ItemsOfFewCells::value_type::first);
    for (const grid::Joined& group : by_sides(solid, next)) {
      const grid::Part its{0, 0, group.intervals};
      if ((known == shred.items.end() || (group.items & ~known->second) != 0) &&
          are_glued_across(mine, its, face))
        return true;
    }
  }
  return false;
}

/// Does it lie on the same side of all cuts as something beside it, or as a dent in something? Then it hangs on that.
bool is_on_same_sides(const grid::Solid& solid, const Shred& shred) {
  return std::ranges::any_of(shred.items, [&](const auto& of_cell) {
    const auto& [c, items] = of_cell;
    const std::vector<grid::Joined> groups = by_sides(solid, c);
    return std::ranges::any_of(groups,
                               [&, cell = c, known = items](const grid::Joined& group) {
                                 return (group.items & known) != 0 &&
                                        ((group.items & ~known) != 0 ||
                                         is_held_across_faces(solid, shred, cell, group.intervals));
                               }) ||
           std::ranges::any_of(dents(solid, c), [known = items](const Dent& dent) {
             return (dent.skin & known) != 0 && (dent.around & ~known) != 0;
           });
  });
}

/// Of all shreds at the new cuts.
TakenBack cuts_to_leave(const grid::Solid& solid, const NewCuts& new_cuts) {
  TakenBack back;
  ItemsOfCells seen, large; // of shreds, and of what is more
  for (const CellId c : grid::touched_cells(solid.grid, new_cuts.edges, new_cuts.segments))
    for (const grid::Part& part : whole_parts_of(grid::without_joined(grid::cuts_of(solid, c)))) {
      if (holds(seen, c, part.items()) || holds(large, c, part.items()))
        continue;
      if (const auto shred = shred_at(solid, c, std::countr_zero(part.items()), large,
                                      [&](const CellId cell) { return grid::cuts_of(solid, cell); })) {
        add(seen, shred->items);
        if (!is_on_same_sides(solid, *shred))
          leave(solid, *shred, new_cuts, back);
      }
    }
  return back;
}

} // namespace

void leave_shreds(grid::Solid& solid, std::vector<EdgeId>& edges, std::vector<SkinSegment>& segments) {
  Taken<EdgeId> taken_edges;
  Taken<SkinSegment> taken_segments;
  for (;;) { // what stays may be a shred still, with one beside it
    TakenBack back = cuts_to_leave(solid, {edges, segments});
    if (take_back(solid, edges, back.edges, taken_edges) +
          take_back(solid, segments, back.segments, taken_segments) ==
        0)
      return;
  }
}

bool is_small(const grid::Solid& solid, const CellId cell, const int item, const CutsOfCell& cuts_of) {
  ItemsOfCells large;
  return shred_at(solid, cell, item, large, cuts_of).has_value();
}

} // namespace kerf::cut
