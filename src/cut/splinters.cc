#include "cut/splinters.h"

#include "base/function_ref.h"
#include "cut/sides.h"
#include "grid/material.h"
#include "grid/parts.h"

#include <algorithm>
#include <bit>
#include <deque>
#include <map>
#include <set>

namespace kerf::cut {

namespace {

namespace cube = grid::cube;
namespace skeleton = grid::skeleton;
using grid::CellId;
using grid::Items;
using grid::Joined;
using grid::Part;
using grid::Solid;

constexpr double of_splinter = 1;       // of a cube
constexpr std::size_t most_around = 64; // cells of a splinter, and between it and the rest of its wedge

using ItemsOfCells = std::map<CellId, Items>;

bool holds_any(const ItemsOfCells& all, const CellId cell, const Items items) {
  const auto known = all.find(cell);
  return known != all.end() && (known->second & items) != 0;
}

/// What hangs together with a part of a cell, as copies do (grid/complex.h).
class Lumps {
 public:
  explicit Lumps(const Solid& solid) : solid_(solid) {}

  /// Null: it is in more cells than a splinter.
  const ItemsOfCells* at(const CellId cell, const Items items) {
    for (const ItemsOfCells& lump : lumps_)
      if (holds_any(lump, cell, items))
        return &lump;
    if (holds_any(large_, cell, items))
      return nullptr;
    ItemsOfCells lump;
    if (find(cell, items, lump))
      return &lumps_.emplace_back(std::move(lump));
    for (const auto& [c, of_cell] : lump)
      large_[c] |= of_cell;
    return nullptr;
  }

 private:
  const grid::Parts& parts(const CellId c) {
    const auto [known, is_new] = parts_.try_emplace(c);
    if (is_new)
      known->second = grid::whole_parts_of(grid::cuts_of_copies(solid_, c));
    return known->second;
  }

  /// All of it; false where it is more than a splinter, some of it then.
  bool find(const CellId cell, const Items items, ItemsOfCells& lump) {
    std::vector<std::pair<CellId, Part>> open;
    const auto reach = [&](const CellId c, const Part& part) {
      if (holds_any(lump, c, part.items()))
        return;
      lump[c] |= part.items();
      open.emplace_back(c, part);
    };
    for (const Part& part : parts(cell))
      if ((part.items() & items) != 0)
        reach(cell, part);
    while (!open.empty()) {
      const auto [c, part] = open.back();
      open.pop_back();
      if (lump.size() > most_around || holds_any(large_, c, part.items()))
        return false;
      for (int face = 0; face < cube::n_faces; ++face)
        if (const CellId next = solid_.grid.neighbour(c, face); next.valid())
          for (const Part& its : parts(next))
            if (are_glued_across(part, its, face))
              reach(next, its);
    }
    return true;
  }

  const Solid& solid_;
  std::map<CellId, grid::Parts> parts_;
  std::deque<ItemsOfCells> lumps_;
  ItemsOfCells large_;
};

/// Of a cube [1].
double volume(const Solid& solid, const ItemsOfCells& lump) {
  double sum = 0;
  for (const auto& [c, items] : lump)
    for (const auto& [t, vertex] : grid::pieces_of(solid, c, items))
      sum += grid::volume(t);
  return sum;
}

/// Does something that `counts` lie on its sides of all cuts, from interval to interval, through cells in which nothing
/// else does? Null counts too: something large.
bool is_led_to(const Solid& solid, const ItemsOfCells& lump, Lumps& lumps,
               const FunctionRef<bool(const ItemsOfCells*)> counts) {
  std::vector<std::pair<CellId, Part>> open;
  std::map<CellId, grid::Intervals> seen;
  const auto reach = [&](const CellId c, const grid::Intervals intervals) {
    if (intervals == 0 || (seen[c] & intervals) != 0)
      return;
    seen[c] |= intervals;
    open.emplace_back(c, Part{0, 0, intervals});
  };
  const auto reach_all = [&](const ItemsOfCells& of) {
    for (const auto& [c, items] : of)
      for (const Joined& group : all_by_sides(solid, c))
        if ((group.items & items) != 0)
          reach(c, group.intervals);
  };
  std::set<const ItemsOfCells*> known = {&lump};
  reach_all(lump);
  while (!open.empty() && seen.size() <= most_around) {
    const auto [c, part] = open.back();
    open.pop_back();
    for (int face = 0; face < cube::n_faces; ++face) {
      const CellId next = solid.grid.neighbour(c, face);
      if (!next.valid())
        continue;
      for (const Joined& group : all_by_sides(solid, next)) {
        if (!are_glued_across(part, {0, 0, group.intervals}, face))
          continue;
        reach(next, group.intervals);
        if (group.items == 0)
          continue;
        const ItemsOfCells* const other = lumps.at(next, group.items);
        if (known.insert(other).second && counts(other))
          return true;
        reach_all(*other);
      }
    }
  }
  return false;
}

/// A segment that is cut between a splinter and something else.
struct Rift {
  CellId cell;
  Items inner, outer; ///< its ends
  double distance;    ///< of the cut from the splinter's end [m]
};

/// The nearest first.
std::vector<Rift> rifts_of(const Solid& solid, const ItemsOfCells& lump) {
  std::vector<Rift> rifts;
  for (const auto& [c, items] : lump) {
    const grid::CellCuts cuts = grid::cuts_of(solid, c);
    for (grid::Segments left = cuts.blades; left != 0; left &= left - 1) {
      const int segment = std::countr_zero(left);
      const auto& [a, b] = cuts.skeleton().segment[segment].ends;
      if (((items >> a ^ items >> b) & 1) == 0)
        continue;
      const int inner = items >> a & 1 ? a : b;
      const Vec3 to_cut = grid::segment_point(solid, c, cuts.skeleton(), segment) - grid::item_point(solid, c, inner);
      rifts.push_back({c, Items(1) << inner, Items(1) << (inner == a ? b : a), to_cut.norm()});
    }
  }
  std::ranges::stable_sort(rifts, {}, &Rift::distance);
  return rifts;
}

} // namespace

std::vector<HeldSplinter> held_splinters(const Solid& solid, const std::span<const CellId> cells,
                                         const std::span<const HeldSplinter> held_before,
                                         const std::set<CellId>& unsettled, const Points& x) {
  std::vector<HeldSplinter> held;
  Lumps lumps(solid);
  std::set<const ItemsOfCells*> seen;
  const auto has_intervals = [&](const CellId c) {
    const auto* const groups = c.valid() ? solid.cuts.joined(c) : nullptr;
    return groups && std::ranges::any_of(*groups, [](const Joined& group) { return group.intervals != 0; });
  };
  const auto was_held = [&](const ItemsOfCells& lump) {
    return std::ranges::any_of(held_before, [&](const HeldSplinter& splinter) {
      return holds_any(lump, splinter.cell, splinter.inner) && lump.size() <= splinter.n_cells;
    });
  };
  const auto is_less_than_the_rest = [&](const ItemsOfCells& lump, const double own) {
    return is_led_to(solid, lump, lumps, [&, least = was_held(lump) ? 0 : own](const ItemsOfCells* const other) {
      return !other || (!was_held(*other) && volume(solid, *other) > least);
    });
  };
  const auto may_be_splinter = [&](const ItemsOfCells& lump) {
    return std::ranges::none_of(lump, [&](const auto& of) { return unsettled.contains(of.first); }) &&
           std::ranges::any_of(lump, [&](const auto& of) { return has_intervals(of.first); });
  };
  for (const CellId c : cells) {
    bool is_near = has_intervals(c) || std::ranges::find(held_before, c, &HeldSplinter::cell) != held_before.end();
    for (int face = 0; face < cube::n_faces && !is_near; ++face)
      is_near = has_intervals(solid.grid.neighbour(c, face));
    if (!is_near)
      continue;
    for (const Part& part : grid::whole_parts_of(grid::cuts_of_copies(solid, c))) {
      const ItemsOfCells* const lump = lumps.at(c, part.items());
      if (!lump || !seen.insert(lump).second || !may_be_splinter(*lump))
        continue;
      const double own = volume(solid, *lump);
      if (own >= of_splinter || !is_less_than_the_rest(*lump, own))
        continue;
      for (const auto& [cell, inner, outer, distance] : rifts_of(solid, *lump)) {
        if (solid.cuts.front(cell) || lumps.at(cell, outer))
          continue;
        const std::vector<Joined> both = near_each_other(solid, cell, {{inner | outer, 0}}, x);
        if (!both.empty()) {
          held.push_back({cell, inner, both.front(), lump->size()});
          break;
        }
      }
    }
  }
  return held;
}

} // namespace kerf::cut
