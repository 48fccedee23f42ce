#include "tests/fuzz/items.h"

#include "tests/grid/slow_parts.h"

#include <algorithm>
#include <iterator>
#include <bit>
#include <map>

namespace kerf::fuzz {

namespace slow = grid::slow;
namespace skeleton = grid::skeleton;
using grid::CellId;
using grid::EdgeId;

namespace {

class Finder {
 public:
  explicit Finder(const grid::Grid& grid) : grid_(grid) {
    material_.is_material = [&grid](const slow::Point& p) {
      const auto node = grid.find_node({p[0] / 2, p[1] / 2, p[2] / 2});
      return node && grid.is_material(*node);
    };
    for (const auto c : ids<CellId>(grid.n_cells()))
      add(c);
    found.n_names = names_.size();
  }

  Items found;

 private:
  Item name(const slow::Item& item) { return names_.emplace(item, static_cast<Item>(names_.size())).first->second; }

  void add(const CellId c) {
    const Index3 cell = slow::lattice_cell(grid_, c);
    const unsigned material = grid::material_of(grid_, c);
    std::array<Item, skeleton::n_items> names;
    for (int i = 0; i < skeleton::n_items; ++i)
      names[i] = grid::skeleton_of(material).items >> i & 1 ? name(slow::named(material, i, cell)) : Items::none;
    found.name.push_back(names);
    const auto numbers = number_of_skin(c);
    std::vector<std::uint32_t> of_cell;
    for (const slow::Segment& walked : slow::segments(material_, slow::closure(slow::cell_centre(cell)))) {
      const auto [at, is_new] = segments_.emplace(walked, static_cast<std::uint32_t>(found.all.size()));
      if (is_new)
        found.all.push_back(segment(walked, numbers));
      of_cell.push_back(at->second);
    }
    found.of_cell.push_back(of_cell);
  }

  /// The numbers by which cuts name a cell's segments of the skin.
  std::map<slow::Segment, grid::SkinSegment> number_of_skin(const CellId c) const {
    std::map<slow::Segment, grid::SkinSegment> numbers;
    for (auto left = grid::skeleton_of(grid::material_of(grid_, c)).segments & ~skeleton::lines; left != 0;
         left &= left - 1) {
      const auto number = grid::skin_segment(grid_, c, std::countr_zero(left));
      numbers[slow::walked(material_, grid_, number)] = number;
    }
    return numbers;
  }

  /// The edge on which a segment lies: between two nodes, or of the point of the skin beside a node.
  ItemSegment segment(const slow::Segment& walked, const std::map<slow::Segment, grid::SkinSegment>& numbers) {
    const slow::Item &a = *walked.begin(), &b = *walked.rbegin();
    ItemSegment result{{name(a), name(b)}, {}, {}};
    if (slow::n_odd(a.at) > 0 && slow::n_odd(b.at) > 0) {
      result.of_skin = numbers.at(walked);
      return result;
    }
    slow::Point at = slow::n_odd(a.at) == 1 ? a.at : b.at;
    if (slow::n_odd(at) == 0)
      for (int axis = 0; axis < 3; ++axis)
        at[axis] = (a.at[axis] + b.at[axis]) / 2;
    result.edge = grid_.find_edge({at[0] / 2, at[1] / 2, at[2] / 2}, slow::axis_of(at)).value();
    return result;
  }

  const grid::Grid& grid_;
  slow::Material material_;
  std::map<slow::Item, Item> names_;
  std::map<slow::Segment, std::uint32_t> segments_;
};

} // namespace

Items items_of(const grid::Grid& grid) { return Finder(grid).found; }

bool is_cut(const grid::Solid& solid, const ItemSegment& segment) {
  if (!segment.edge.valid())
    return solid.cuts.is_cut(segment.of_skin);
  const auto& [lower, upper] = solid.grid.ends(segment.edge);
  return solid.grid.is_material(lower) == solid.grid.is_material(upper) ? solid.cuts.is_cut(segment.edge)
                                                                        : solid.cuts.is_cut_twice(segment.edge);
}

bool is_ahead(const grid::Solid& solid, const CellId cell, const ItemSegment& segment) {
  const grid::Front* const front = solid.cuts.front(cell);
  for (grid::Segments left = front ? front->ahead : 0; left != 0; left &= left - 1) {
    const int s = std::countr_zero(left);
    if (s < skeleton::first_half ? solid.grid.edges(cell)[s] == segment.edge
                                 : !segment.edge.valid() && grid::skin_segment(solid.grid, cell, s) == segment.of_skin)
      return true;
  }
  return false;
}

namespace {

bool parts_copies(const grid::Solid& solid, const CellId cell, const ItemSegment& segment) {
  return is_cut(solid, segment) || is_ahead(solid, cell, segment);
}

} // namespace

bool is_cut_at_skin(const grid::Solid& solid, const Items& items, const CellId cell) {
  const auto nodes = solid.grid.nodes(cell);
  return std::ranges::any_of(nodes, [&](const auto n) { return !solid.grid.is_material(n); }) &&
         std::ranges::any_of(items.of_cell[cell],
                             [&](const auto s) { return parts_copies(solid, cell, items.all[s]); });
}

namespace {

/// What lies on the same sides of all cuts. Where a front parts the copies that is not asked.
const std::vector<grid::Joined>* joined(const grid::Solid& solid, const CellId cell) {
  return solid.cuts.front(cell) ? nullptr : solid.cuts.joined(cell);
}

void add_joined(const grid::Solid& solid, const Items& items, const CellId cell, ItemLinks& links) {
  if (const auto* const groups = joined(solid, cell))
    for (const grid::Joined& group : *groups)
      for (int i = 0; i < grid::skeleton::n_items; ++i)
        if (group.items >> i & 1)
          links.push_back({items.name[cell][std::countr_zero(group.items)], items.name[cell][i]});
}

} // namespace

ItemLinks links_above(const grid::Solid& solid, const Items& items, const CellId cell, const int axis) {
  ItemLinks links;
  const int face = 2 * axis + 1;
  const CellId above = solid.grid.neighbour(cell, face);
  const auto* const groups = joined(solid, cell);
  const auto* const others = above.valid() ? joined(solid, above) : nullptr;
  if (!groups || !others)
    return links;
  for (const grid::Joined& one : *groups)
    for (const grid::Joined& other : *others) {
      bool is_shared = false;
      for (int i = 0; i < 4; ++i) { // two bits of each line, from 24 on one of each half
        is_shared |= (one.intervals >> 2 * grid::cube::face_lines[face][i] & 3 &
                      other.intervals >> 2 * grid::cube::face_lines[face - 1][i]) != 0;
        is_shared |= (one.intervals >> (24 + 4 * face + i) & 1 & other.intervals >> (20 + 4 * face + i)) != 0;
      }
      if (is_shared)
        links.push_back(
          {items.name[cell][std::countr_zero(one.items)], items.name[above][std::countr_zero(other.items)]});
    }
  return links;
}

ItemLinks links(const grid::Solid& solid, const Items& items) {
  ItemLinks result;
  for (const ItemSegment& segment : items.all)
    if (!is_cut(solid, segment))
      result.push_back(segment.ends);
  for (const auto cell : ids<CellId>(solid.grid.n_cells())) {
    add_joined(solid, items, cell, result);
    for (int axis = 0; axis < 3; ++axis)
      std::ranges::copy(links_above(solid, items, cell, axis), std::back_inserter(result));
  }
  return result;
}

ItemLinks links(const grid::Solid& solid, const Items& items, const CellId cell) {
  ItemLinks result;
  for (const auto s : items.of_cell[cell])
    if (!parts_copies(solid, cell, items.all[s]))
      result.push_back(items.all[s].ends);
  add_joined(solid, items, cell, result);
  return result;
}

} // namespace kerf::fuzz
