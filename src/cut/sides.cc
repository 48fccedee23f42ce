#include "cut/sides.h"

#include "base/sort_unique.h"
#include "cut/dents.h"
#include "cut/hollows.h"

#include <algorithm>
#include <bit>
#include <map>
#include <optional>
#include <ranges>
#include <span>
#include <utility>

namespace kerf::cut {

namespace {

namespace skeleton = grid::skeleton;
using grid::CellId;
using grid::CutLabel;
using grid::Intervals;
using grid::Items;
using grid::Joined;
using grid::Segments;
using grid::Solid;

constexpr int most_labels = 8;

/// By label: how an item lies to it.
using Sides = std::array<std::int8_t, most_labels>;

/// What crosses the segments of a cell.
class CellCrossings {
 public:
  CellCrossings(const Solid& solid, const CellId c, const grid::CellCuts& cuts) : of_(cuts.skeleton()) {
    const auto edges = solid.grid.edges(c);
    for (Segments left = solid.cuts.has_later_cuts() ? of_.segments : cuts.blades & of_.segments; left != 0;
         left &= left - 1) {
      const int segment = std::countr_zero(left);
      const auto& [a, b] = of_.segment[segment].ends;
      const auto add_all = [&](const auto& at, const bool is_reversed) {
        const auto* const first = (cuts.blades >> segment & 1) != 0 ? solid.cuts.find(at) : nullptr;
        const auto later_ones = solid.cuts.later_cuts(at);
        if (!first && later_ones.empty())
          return;
        const Vec3 along = grid::item_point(solid, c, b) - grid::item_point(solid, c, a);
        if (first)
          add(segment, along, {first->t, first->normal, first->label}, is_reversed);
        for (const grid::LaterCut& later : later_ones)
          if (!first || later.label != first->label)
            add(segment, along, later, is_reversed);
      };
      if (segment < skeleton::first_half)
        add_all(edges[segment], a != grid::cube::line_vertices[segment][0]);
      else
        add_all(grid::skin_segment(solid.grid, c, segment), false);
      std::ranges::sort(crossings_[segment], {}, &Crossing::t);
    }
  }

  /// 0 where there are more labels than can be told apart.
  int n_labels() const { return n_labels_ > most_labels ? 0 : n_labels_; }

  /// Of each item; nothing where they depend on the way.
  std::optional<std::array<Sides, skeleton::n_items>> sides() const {
    std::array<Sides, skeleton::n_items> result{};
    Items known = 0;
    for (Items left = of_.items; left != 0; left = of_.items & ~known) {
      known |= left & -left;
      for (Items before = 0; before != known;) {
        before = known;
        for (Segments open = of_.segments; open != 0; open &= open - 1) {
          const int segment = std::countr_zero(open);
          const auto& [a, b] = of_.segment[segment].ends;
          if ((known >> a & 1) != 0 && (known >> b & 1) == 0)
            result[b] = beyond(result[a], segment, 1);
          else if ((known >> b & 1) != 0 && (known >> a & 1) == 0)
            result[a] = beyond(result[b], segment, -1);
          else
            continue;
          known |= Items(1) << a | Items(1) << b;
        }
      }
    }
    for (Segments left = of_.segments; left != 0; left &= left - 1) {
      const int segment = std::countr_zero(left);
      const auto& [a, b] = of_.segment[segment].ends;
      if (beyond(result[a], segment, 1) != result[b])
        return std::nullopt;
    }
    return result;
  }

  /// Calls f(interval, its sides, the segment, where its middle lies along that from its first end [1]) for all intervals
  /// that a cell can tell apart: up to two of a line, one of a half.
  template <class Function>
  void for_each_interval(const std::array<Sides, skeleton::n_items>& sides, const Function& f) const {
    for (int segment = 0; segment < skeleton::first_spoke; ++segment) {
      const auto& crossings = crossings_[segment];
      const Intervals all = skeleton::intervals_of(segment);
      const auto n = static_cast<int>(crossings.size());
      if (n < 2 || n > std::popcount(all) + 1)
        continue;
      Sides at = sides[of_.segment[segment].ends[0]];
      for (int i = 0; i + 1 < n; ++i) {
        at[crossings[i].label] = static_cast<std::int8_t>(at[crossings[i].label] + crossings[i].step);
        if (crossings[i + 1].t - crossings[i].t > grid::min_edge_parameter)
          f(Intervals(1) << (std::countr_zero(all) + i), at, segment,
            0.5 * (crossings[i].t + crossings[i + 1].t));
      }
    }
  }

 private:
  struct Crossing {
    double t;  ///< from the segment's first end; of a line in edges of the grid [1]
    int label; ///< by its number here
    int step;  ///< to the sides beyond it
  };

  void add(const int segment, const Vec3& along, const grid::LaterCut& cut, const bool is_reversed) {
    const auto [first, is_new] = first_.try_emplace(cut.label, First{n_labels_, cut.normal});
    n_labels_ += is_new ? 1 : 0;
    const auto& [number, of_first] = first->second;
    if (number < most_labels)
      crossings_[segment].push_back({is_reversed ? 1 - cut.t : cut.t, number,
                                     (cut.normal.dot(along) > 0) == (cut.normal.dot(of_first) > 0) ? 1 : -1});
  }

  Sides beyond(Sides sides, const int segment, const int way) const {
    for (const auto& [t, label, step] : crossings_[segment])
      sides[label] = static_cast<std::int8_t>(sides[label] + way * step);
    return sides;
  }

  struct First {
    int number;
    Vec3 normal; ///< to whose side others are turned
  };

  const grid::Skeleton& of_;
  int n_labels_ = 0;
  std::map<CutLabel, First> first_;
  std::array<std::vector<Crossing>, skeleton::n_segments> crossings_;
};

bool are_near(const Solid& solid, const Points& x, const grid::CopyId a, const int v, const grid::CopyId b,
              const int w) {
  constexpr double near = 0.25;
  const auto& copies = solid.complex.copies;
  return (x[copies[a].corners[v].value] - x[copies[b].corners[w].value]).norm() <= near * solid.grid.h();
}

/// At all corners.
bool are_near(const Solid& solid, const Points& x, const grid::CopyId a, const grid::CopyId b) {
  return std::ranges::all_of(std::views::iota(0, grid::cube::n_vertices),
                             [&](const int v) { return are_near(solid, x, a, v, b, v); });
}

/// Without those of a face across which the copy that has them is too far away.
Intervals near_each_other(const Solid& solid, const CellId c, const Joined& group, const Points& x) {
  Intervals kept = group.intervals;
  const grid::CopyId own = copy_of(solid, c, group.items);
  for (int face = 0; face < grid::cube::n_faces; ++face) {
    const CellId next = solid.grid.neighbour(c, face);
    const auto* const there = next.valid() ? solid.cuts.joined(next) : nullptr;
    if (!there)
      continue;
    const int axis = grid::cube::face_axis(face);
    for (const Joined& others : *there) {
      if (!are_glued_across({0, 0, group.intervals}, {0, 0, others.intervals}, face))
        continue;
      const grid::CopyId other = copy_of(solid, next, others.items);
      if (!std::ranges::all_of(grid::cube::face_vertices[face],
                               [&](const int v) { return are_near(solid, x, own, v, other, v ^ 1 << axis); }))
        for (int i = 0; i < 8; ++i)
          kept &= ~skeleton::intervals_of(skeleton::in_face(face, i));
    }
  }
  return kept;
}

/// How a group lies.
struct Lie {
  Sides sides;
  Items among; // these, over segments, cut or not

  bool is(const Sides& at, const Items items) const { return sides == at && (among & items) != 0; }
};

/// Some groups, ascending, go into the first of them; the others have nothing then.
void join_first(std::vector<Joined>& groups, const std::span<const std::size_t> some) {
  for (std::size_t k = 1; k < some.size(); ++k)
    groups[some.front()] |= std::exchange(groups[some[k]], {});
}

/// Intervals join the group that lies as they do; where a hollow lies between several, all those that they see, and these
/// are one then. What sees none belongs to nothing here.
void add_intervals(std::vector<Joined>& groups, std::vector<Lie>& lie, const grid::Skeleton& skeleton,
                   const CellCrossings& crossings, const std::array<Sides, skeleton::n_items>& sides,
                   const std::optional<Hollows>& hollows) {
  const std::size_t n_of_parts = groups.size();
  std::vector<std::vector<std::size_t>> seen;
  crossings.for_each_interval(sides, [&](const Intervals interval, const Sides& at, const int segment, const double t) {
    const auto& [a, b] = skeleton.segment[segment].ends;
    const Items ends = Items(1) << a | Items(1) << b;
    std::vector<std::size_t> beside;
    for (std::size_t i = 0; i < n_of_parts; ++i)
      if (groups[i].items != 0 && lie[i].is(at, ends))
        beside.push_back(i);
    if (beside.size() > 1 && hollows) {
      const Vec3 p = hollows->point(skeleton, segment, t);
      std::erase_if(beside, [&](const std::size_t i) { return hollows->lie_between(groups[i].items, p); });
    }
    if (beside.empty()) {
      std::size_t i = n_of_parts;
      while (i < groups.size() && !lie[i].is(at, ends))
        ++i;
      if (i == groups.size()) {
        lie.push_back({at, skeleton.reachable(ends, 0)});
        groups.emplace_back();
      }
      beside.push_back(i);
    }
    groups[beside.front()].intervals |= interval;
    if (beside.size() > 1)
      seen.push_back(std::move(beside));
  });
  while (!seen.empty()) {
    const std::vector<std::size_t> some = std::move(seen.back());
    seen.pop_back();
    join_first(groups, some);
    for (std::vector<std::size_t>& others : seen) {
      for (std::size_t& i : others)
        if (std::ranges::binary_search(some, i))
          i = some.front();
      sort_unique(others);
    }
  }
  std::erase_if(groups, [](const Joined& group) { return group.items == 0 && group.intervals == 0; });
}

} // namespace

grid::CopyId copy_of(const Solid& solid, const CellId c, const Items items) {
  const auto& complex = solid.complex;
  for (const grid::CopyId copy : complex.copies_of(c))
    if ((complex.copies[copy].items() & items) != 0)
      return copy;
  // Of one that does not know its skin yet.
  return complex.copy_at(c, grid::cuts_of(solid, c).skeleton().vertex[std::countr_zero(items)]);
}

std::vector<Joined> all_by_sides(const Solid& solid, const CellId c) {
  const grid::CellCuts cuts = grid::without_joined(grid::cuts_of(solid, c));
  const grid::Parts parts = grid::parts_of(cuts);
  std::vector<Joined> groups;
  if (parts.n < (solid.cuts.has_later_cuts() ? 2 : 3))
    return groups;
  const CellCrossings meetings(solid, c, cuts);
  if (meetings.n_labels() < 2)
    return groups;
  const auto sides = meetings.sides();
  if (!sides)
    return groups;
  const auto& skeleton = cuts.skeleton();
  std::vector<Lie> lie; // of the groups
  std::optional<Hollows> hollows; // of a cell in which they are asked for
  for (const grid::Part& part : parts) { // joins all that it is one with
    const Sides& at = (*sides)[std::countr_zero(part.items())];
    std::vector<std::size_t> one_with;
    for (std::size_t i = 0; i < groups.size(); ++i) {
      if (!lie[i].is(at, part.items()))
        continue;
      if (cuts.has_skin() && !hollows)
        hollows.emplace(solid, c, skeleton.items);
      if (!hollows || !hollows->lie_between(groups[i].items, part.items()))
        one_with.push_back(i);
    }
    if (one_with.empty()) {
      lie.push_back({at, skeleton.reachable(part.items(), 0)});
      groups.push_back({part.items(), 0});
      continue;
    }
    groups[one_with.front()].items |= part.items();
    join_first(groups, one_with);
  }
  add_intervals(groups, lie, skeleton, meetings, *sides, hollows);
  return groups;
}

std::vector<Joined> by_sides(const Solid& solid, const CellId c) {
  std::vector<Joined> groups = all_by_sides(solid, c);
  if (!groups.empty()) {
    const grid::Parts parts = grid::parts_of(grid::without_joined(grid::cuts_of(solid, c)));
    std::erase_if(groups, [&](const Joined& group) {
      return group.items == 0 || (group.intervals == 0 && std::ranges::any_of(parts, [&](const grid::Part& part) {
                                    return part.items() == group.items;
                                  }));
    });
  }
  return groups;
}

std::vector<Joined> on_same_sides(const Solid& solid, const CellId c) {
  std::vector<Joined> groups = by_sides(solid, c);
  for (const Dent& dent : dents(solid, c))
    groups.push_back(dent.joined());
  return groups;
}

std::vector<Joined> without_cuts(const Solid& solid, const CellId c, const Segments cuts) {
  const std::vector<Joined> settled = by_sides(solid, c);
  std::vector<Joined> groups;
  for (const grid::Part& part : whole_parts_of(grid::without(grid::cuts_of(solid, c), cuts))) {
    Joined& group = groups.emplace_back(Joined{part.items(), part.intervals});
    for (const Joined& side : settled)
      if ((side.items & group.items) != 0)
        group.intervals |= side.intervals;
  }
  for (const Dent& dent : dents(solid, c))
    groups.push_back(dent.joined());
  return groups;
}

std::vector<Joined> undivided(const Solid& solid, const CellId c, const std::vector<Joined>& groups) {
  const grid::Parts parts = grid::parts_of(grid::without_joined(grid::cuts_of(solid, c)));
  std::vector<Joined> result;
  for (const Joined& group : groups) {
    std::map<grid::CopyId, Items> of_copies;
    for (const grid::Part& part : parts)
      if ((part.items() & group.items) != 0)
        of_copies[copy_of(solid, c, part.items())] |= part.items();
    for (const auto& [copy, items] : of_copies)
      result.push_back(
        {items, of_copies.size() == 1 ? group.intervals : group.intervals & solid.complex.copies[copy].intervals});
  }
  return result;
}

std::vector<Joined> near_each_other(const Solid& solid, const CellId c, std::vector<Joined> groups, const Points& x) {
  const grid::Parts parts = grid::parts_of(grid::without_joined(grid::cuts_of(solid, c)));
  for (Joined& group : groups) {
    Items kept = 0;
    for (const grid::Part& part : parts) {
      if ((part.items() & group.items) == 0)
        continue;
      if (are_near(solid, x, copy_of(solid, c, group.items), copy_of(solid, c, part.items())))
        kept |= part.items();
    }
    group.items = kept;
    group.intervals = near_each_other(solid, c, group, x);
  }
  std::erase_if(groups, [&](const Joined& group) {
    return group.intervals == 0 &&
           std::ranges::any_of(parts, [&](const grid::Part& part) { return part.items() == group.items; });
  });
  return groups;
}

bool are_near(const Solid& solid, const CellId c, const std::array<std::uint8_t, 2>& items, const Points& x) {
  const auto copy = [&](const int i) { return copy_of(solid, c, Items(1) << items[i]); };
  return are_near(solid, x, copy(0), copy(1));
}

bool are_near_at(const Solid& solid, const grid::CopyId a, const grid::CopyId b, const Items items, const Points& x) {
  for (int face = 0; face < grid::cube::n_faces; ++face)
    if (grid::detail::in_face(grid::Part::of(items), face) != 0 &&
        !std::ranges::all_of(grid::cube::face_vertices[face],
                             [&](const int v) { return are_near(solid, x, a, v, b, v); }))
      return false;
  return true;
}

} // namespace kerf::cut
