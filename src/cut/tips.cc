#include "cut/tips.h"

#include "grid/material.h"
#include "grid/touched.h"

#include <algorithm>
#include <bit>
#include <map>
#include <optional>

namespace kerf::cut {

namespace {

namespace skeleton = grid::skeleton;
using grid::CellId;
using grid::Items;
using grid::SkinSegment;

constexpr double no_volume = 1e-9;     // of a cube
constexpr std::size_t most_cells = 64; // of a tip; what is larger has volume

using Tip = std::map<CellId, Items>; // points of the skin that hang together

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
  const grid::EdgeId edge = grid.edges(c)[item - skeleton::first_on_line];
  for (const CellId other : grid.cells(edge))
    if (other.valid() && other != c) {
      const auto edges = grid.edges(other);
      f(other, skeleton::on_line(static_cast<int>(std::find(edges.begin(), edges.end(), edge) - edges.begin())));
    }
}

/// All that hangs together with a point of the skin; nothing where there is a node among it.
std::optional<Tip> tip_at(const grid::Solid& solid, const CellId cell, const int item) {
  Tip tip;
  std::vector<std::pair<CellId, int>> open = {{cell, item}};
  while (!open.empty()) {
    const auto [c, i] = open.back();
    open.pop_back();
    Items& known = tip[c];
    if (known >> i & 1)
      continue;
    const grid::CellCuts cuts = grid::cuts_of(solid, c);
    const Items found = cuts.skeleton().reachable(Items(1) << i, cuts.blades);
    if ((found & 0xff) != 0 || tip.size() > most_cells)
      return std::nullopt;
    known |= found;
    for (Items left = found; left != 0; left &= left - 1)
      for_each_sharing(solid.grid, c, std::countr_zero(left),
                       [&](const CellId other, const int its) { open.emplace_back(other, its); });
  }
  return tip;
}

/// Of a cube [1].
double volume(const grid::Solid& solid, const Tip& tip) {
  double sum = 0;
  for (const auto& [c, items] : tip)
    for (const auto& [t, vertex] : grid::pieces_of(solid, c, items))
      sum += grid::volume(t);
  return sum;
}

} // namespace

std::size_t leave_tips_whole(grid::Solid& solid, std::vector<SkinSegment>& segments) {
  std::vector<SkinSegment> back;
  for (const CellId c : grid::touched_cells(solid.grid, {}, segments)) {
    const grid::CellCuts cuts = grid::cuts_of(solid, c);
    for (const grid::Part& part : parts_of(cuts)) {
      if (part.nodes != 0 || part.skin == 0)
        continue;
      const auto tip = tip_at(solid, c, std::countr_zero(part.items()));
      if (!tip || volume(solid, *tip) > no_volume)
        continue;
      for (grid::Segments left = cuts.blades & ~skeleton::lines; left != 0; left &= left - 1) {
        const int segment = std::countr_zero(left);
        const auto& [a, b] = cuts.skeleton().segment[segment].ends;
        const SkinSegment at = grid::skin_segment(solid.grid, c, segment);
        if (((part.items() >> a ^ part.items() >> b) & 1) != 0 && std::ranges::binary_search(segments, at))
          back.push_back(at);
      }
    }
  }
  std::sort(back.begin(), back.end());
  back.erase(std::unique(back.begin(), back.end()), back.end());
  if (!back.empty()) {
    solid.cuts.take_back(back);
    std::erase_if(segments, [&](const SkinSegment& s) { return std::ranges::binary_search(back, s); });
  }
  return back.size();
}

} // namespace kerf::cut
