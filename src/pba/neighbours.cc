#include "pba/neighbours.h"

#include "pba/point_grid.h"

#include <algorithm>

namespace kerf::pba {

namespace {

double pair_support(const Phyxels& phyxels, const std::uint32_t i, const std::uint32_t j) {
  return 0.5 * (phyxels.support[i] + phyxels.support[j]);
}

std::vector<Pair> find_pairs(const Phyxels& phyxels) {
  const double widest = *std::max_element(phyxels.support.begin(), phyxels.support.end());
  const PointGrid grid(phyxels.rest, widest);
  std::vector<Pair> pairs;
  std::vector<std::uint32_t> near;
  for (std::uint32_t i = 0; i < phyxels.size(); ++i) {
    grid.within(phyxels.rest[i], 0.5 * (phyxels.support[i] + widest), near);
    for (const auto j : near)
      if (j > i && (phyxels.rest[j] - phyxels.rest[i]).norm() < pair_support(phyxels, i, j))
        pairs.push_back({i, j});
  }
  return pairs;
}

} // namespace

Neighbours find_neighbours(const Phyxels& phyxels) {
  Neighbours neighbours = neighbours_of(find_pairs(phyxels), phyxels.size());
  for (const auto& [i, j] : neighbours.pairs)
    neighbours.support.push_back(pair_support(phyxels, i, j));
  return neighbours;
}

Neighbours neighbours_of(std::vector<Pair> pairs, const std::size_t n) {
  Neighbours neighbours;
  neighbours.pairs = std::move(pairs);
  neighbours.start.assign(n + 1, 0);
  for (const Pair& pair : neighbours.pairs)
    for (const auto i : pair)
      ++neighbours.start[i + 1];
  for (std::size_t i = 1; i < neighbours.start.size(); ++i)
    neighbours.start[i] += neighbours.start[i - 1];
  neighbours.phyxel.resize(2 * neighbours.pairs.size());
  neighbours.pair.resize(2 * neighbours.pairs.size());
  std::vector<std::uint32_t> next(neighbours.start.begin(), neighbours.start.end() - 1);
  // Ascending by the lower end, then by the upper: as upper end first, a phyxel meets its lower neighbours in order.
  for (const int end : {1, 0})
    for (std::uint32_t p = 0; p < neighbours.pairs.size(); ++p) {
      const auto at = next[neighbours.pairs[p][end]]++;
      neighbours.phyxel[at] = neighbours.pairs[p][1 - end];
      neighbours.pair[at] = p;
    }
  return neighbours;
}

std::vector<Sight> clear_sights(const Points& from, const Points& to, const std::span<const Pair> pairs) {
  std::vector<Sight> sights;
  sights.reserve(pairs.size());
  for (const Pair& pair : pairs)
    sights.push_back({(to[pair[1]] - from[pair[0]]).norm()});
  return sights;
}

} // namespace kerf::pba
