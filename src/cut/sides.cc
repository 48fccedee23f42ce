#include "cut/sides.h"

#include "grid/parts.h"

#include <algorithm>
#include <bit>
#include <map>
#include <optional>

namespace kerf::cut {

namespace {

namespace skeleton = grid::skeleton;
using grid::CellId;
using grid::CutLabel;
using grid::Items;
using grid::Segments;
using grid::Solid;

constexpr int most_labels = 8;

/// By label: how an item lies to it.
using Sides = std::array<std::int8_t, most_labels>;

/// What crosses the segments of a cell.
class Meetings {
 public:
  Meetings(const Solid& solid, const CellId c, const grid::CellCuts& cuts) : cuts_(cuts), of_(cuts.skeleton()) {
    const auto edges = solid.grid.edges(c);
    for (Segments left = cuts.blades & of_.segments; left != 0; left &= left - 1) {
      const int segment = std::countr_zero(left);
      const auto& [a, b] = of_.segment[segment].ends;
      const Vec3 along = grid::item_point(solid, c, b) - grid::item_point(solid, c, a);
      if (segment < skeleton::first_half) {
        const grid::EdgeCut& cut = *solid.cuts.find(edges[segment]);
        add(segment, along, cut.normal, cut.label);
        for (const grid::LaterCut& later : solid.cuts.later_cuts(edges[segment]))
          add(segment, along, later.normal, later.label);
      } else {
        const grid::SkinSegment at = grid::skin_segment(solid.grid, c, segment);
        const grid::SkinCut& cut = *solid.cuts.find(at);
        add(segment, along, cut.normal, cut.label);
        for (const grid::LaterCut& later : solid.cuts.later_cuts(at))
          add(segment, along, later.normal, later.label);
      }
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

 private:
  void add(const int segment, const Vec3& along, const Vec3& normal, const CutLabel label) {
    const auto [first, is_new] = first_.try_emplace(label, First{n_labels_, normal});
    n_labels_ += is_new ? 1 : 0;
    const auto& [number, of_first] = first->second;
    if (number < most_labels)
      steps_[segment][number] = (normal.dot(along) > 0) == (normal.dot(of_first) > 0) ? 1 : -1;
  }

  Sides beyond(Sides sides, const int segment, const int way) const {
    for (int i = 0; i < most_labels; ++i)
      sides[i] = static_cast<std::int8_t>(sides[i] + way * steps_[segment][i]);
    return sides;
  }

  struct First {
    int number;
    Vec3 normal; ///< to whose side others are turned
  };

  grid::CellCuts cuts_;
  const grid::Skeleton& of_;
  int n_labels_ = 0;
  std::map<CutLabel, First> first_;
  std::array<Sides, skeleton::n_segments> steps_{};
};

/// All items that segments lead to, cut or not.
Items in_reach(const grid::Skeleton& skeleton, const Items from) { return skeleton.reachable(from, 0); }

} // namespace

std::vector<Items> on_same_sides(const Solid& solid, const CellId c) {
  grid::CellCuts cuts = grid::cuts_of(solid, c);
  cuts.joined = nullptr;
  const grid::Parts parts = grid::parts_of(cuts);
  std::vector<Items> groups;
  if (parts.n < 3)
    return groups;
  const Meetings meetings(solid, c, cuts);
  if (meetings.n_labels() < 2)
    return groups;
  const auto sides = meetings.sides();
  if (!sides)
    return groups;
  const auto& skeleton = cuts.skeleton();
  const auto side_of = [&](const Items items) { return (*sides)[std::countr_zero(items)]; };
  Items grouped = 0;
  for (const grid::Part* part = parts.begin(); part != parts.end(); ++part) {
    const Items items = part->items();
    if ((items & grouped) != 0)
      continue;
    Items group = items;
    for (const grid::Part* other = part + 1; other != parts.end(); ++other)
      if (side_of(other->items()) == side_of(items) && (in_reach(skeleton, items) & other->items()) != 0)
        group |= other->items();
    if (group != items)
      groups.push_back(group);
    grouped |= group;
  }
  return groups;
}

std::vector<Items> near_each_other(const Solid& solid, const CellId c, std::vector<Items> groups, const Points& x) {
  constexpr double near = 0.25;
  const auto& complex = solid.complex;
  grid::CellCuts cuts = grid::cuts_of(solid, c);
  cuts.joined = nullptr;
  const grid::Parts parts = grid::parts_of(cuts);
  for (Items& group : groups) {
    Items kept = 0;
    grid::CopyId first;
    for (const grid::Part& part : parts) {
      if ((part.items() & group) == 0)
        continue;
      const auto in_part = [&](const grid::CopyId copy) { return (complex.copies[copy].items() & part.items()) != 0; };
      grid::CopyId of_part;
      for (const grid::CopyId copy : complex.copies_of(c))
        if (in_part(copy))
          of_part = copy;
      if (!first.valid())
        first = of_part;
      double apart = 0;
      for (int v = 0; v < 8 && of_part.valid(); ++v) // else it is of one copy that does not know its skin yet
        apart = std::max(
          apart, (x[complex.copies[first].corners[v].value] - x[complex.copies[of_part].corners[v].value]).norm());
      if (apart <= near * solid.grid.h())
        kept |= part.items();
    }
    group = kept;
  }
  std::erase_if(groups, [&](const Items group) {
    return std::ranges::any_of(parts, [&](const grid::Part& part) { return part.items() == group; });
  });
  return groups;
}

} // namespace kerf::cut
