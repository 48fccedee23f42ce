#include "pba/reach.h"

#include "grid/material.h"

#include <algorithm>
#include <bit>
#include <functional>
#include <map>
#include <queue>
#include <tuple>

namespace kerf::pba {

namespace {

using grid::CopyId;

std::uint32_t nearest(const Vec3& p, const Points& phyxels) {
  return static_cast<std::uint32_t>(
    std::min_element(phyxels.begin(), phyxels.end(),
                     [&](const Vec3& a, const Vec3& b) { return (a - p).squaredNorm() < (b - p).squaredNorm(); }) -
    phyxels.begin());
}

bool is_shorter(const Way& a, const Way& b) { return std::tie(a.length, a.phyxel) < std::tie(b.length, b.phyxel); }

/// Calls f(row, c) for each material node of the copies, as its row.
template <class Function>
void for_each_row(const grid::Solid& solid, const std::span<const grid::NodeId> nodes, const Function& f) {
  for (const auto c : ids<CopyId>(solid.complex.n_copies())) {
    const auto of_cell = solid.grid.nodes(solid.complex.copies[c].cell);
    for (unsigned left = solid.complex.copies[c].nodes; left != 0; left &= left - 1)
      f(static_cast<std::size_t>(std::lower_bound(nodes.begin(), nodes.end(), of_cell[std::countr_zero(left)]) -
                                 nodes.begin()),
        c);
  }
}

} // namespace

Table<CopyId, Way> shortest_ways(const grid::Solid& solid, const Points& phyxels,
                                 const std::span<const CopyId> copies) {
  const double h = solid.grid.h();
  const auto fill = [&](const CopyId c) { return std::max(grid::fill(solid, solid.complex.copies[c]), 0.0); };
  Table<CopyId, Way> ways(solid.complex.n_copies());
  using Step = std::tuple<double, std::uint32_t, CopyId>;
  std::priority_queue<Step, std::vector<Step>, std::greater<>> queue; // Dijkstra's method
  const auto offer = [&](const CopyId c, const Way& way) {
    if (!is_shorter(way, ways[c]))
      return;
    ways[c] = {way.length, way.phyxel, std::min(way.narrowest, fill(c))};
    queue.push({way.length, way.phyxel, c});
  };
  for (std::uint32_t i = 0; i < copies.size(); ++i)
    if (copies[i].valid()) {
      const Vec3 middle = solid.grid.origin(solid.complex.copies[copies[i]].cell) + Vec3::Constant(0.5 * h);
      offer(copies[i], {(phyxels[i] - middle).norm(), i});
    }
  while (!queue.empty()) {
    const auto [length, phyxel, c] = queue.top();
    queue.pop();
    if (const Way way = ways[c]; way.phyxel == phyxel && way.length == length)
      for_each_glued(solid, c, [&](const CopyId other) { offer(other, {length + h, phyxel, way.narrowest}); });
  }
  return ways;
}

Reached reach(const grid::Solid& solid, const std::span<const grid::NodeId> nodes, const Points& rest,
              const Points& phyxels, const std::span<const CopyId> copies, const std::span<const std::uint32_t> blind) {
  Reached reached;
  if (blind.empty())
    return reached;
  const auto ways = shortest_ways(solid, phyxels, copies);
  const grid::Pieces pieces = grid::pieces(solid.complex);
  std::vector<Way> best(nodes.size());
  std::vector<std::uint32_t> piece(nodes.size(), 0);
  for_each_row(solid, nodes, [&](const std::size_t row, const CopyId c) {
    piece[row] = pieces.piece[c];
    if (is_shorter(ways[c], best[row]))
      best[row] = ways[c];
  });
  std::map<std::uint32_t, std::pair<Vec3, double>> orphans; // sum of nodes [m] and their number, by piece
  for (std::size_t row = 0; row < nodes.size(); ++row)
    if (best[row].phyxel == no_phyxel) {
      auto& [sum, n] = orphans.try_emplace(piece[row], Vec3::Zero(), 0.0).first->second;
      sum += rest[row];
      ++n;
    }
  reached.n_orphans = orphans.size();
  for (const auto row : blind) {
    if (best[row].phyxel == no_phyxel) {
      const auto& [sum, n] = orphans.at(piece[row]);
      best[row].phyxel = nearest(sum / n, phyxels);
    }
    reached.phyxel.push_back(best[row].phyxel);
  }
  return reached;
}

} // namespace kerf::pba
