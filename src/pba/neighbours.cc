#include "pba/neighbours.h"

#include "base/union_find.h"
#include "pba/point_grid.h"

#include <algorithm>
#include <limits>
#include <map>

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

/// Phyxels of one piece that pairs join, ascending.
using Part = std::vector<std::uint32_t>;
constexpr double holding = 1.1; ///< support of a pair that holds, in its distances [1]: from a weight of .005 on
constexpr double widened = 1.5; ///< of a pair that is to hold: a weight of .17

/// All parts of pieces that pairs leave in several, but the largest of each.
std::vector<Part> lesser_parts(const std::span<const std::uint32_t> pieces, const Phyxels& phyxels) {
  UnionFind sets(phyxels.size());
  for (const auto& [i, j] : find_pairs(phyxels))
    if (pieces[i] == pieces[j] && holding * (phyxels.rest[j] - phyxels.rest[i]).norm() < pair_support(phyxels, i, j))
      sets.unite(i, j);
  std::map<std::uint32_t, std::map<std::uint32_t, Part>> parts; // by piece and root
  for (std::uint32_t i = 0; i < phyxels.size(); ++i)
    parts[pieces[i]][sets.root(i)].push_back(i);
  std::vector<Part> lesser;
  for (auto& [piece, all] : parts) {
    const auto smaller = [](const auto& a, const auto& b) { return a.second.size() < b.second.size(); };
    all.erase(std::max_element(all.begin(), all.end(), smaller));
    for (auto& [root, part] : all)
      lesser.push_back(std::move(part));
  }
  return lesser;
}

/// The two nearest phyxels of a part and of what else its piece holds.
Pair nearest_outside(const Part& part, const std::span<const std::uint32_t> pieces, const Points& rest) {
  Pair found{};
  double least = std::numeric_limits<double>::max();
  for (std::uint32_t j = 0; j < rest.size(); ++j) {
    if (pieces[j] != pieces[part.front()] || std::binary_search(part.begin(), part.end(), j))
      continue;
    for (const auto i : part)
      if (const double distance = (rest[j] - rest[i]).squaredNorm(); distance < least) {
        least = distance;
        found = {i, j};
      }
  }
  return found;
}

} // namespace

Neighbours find_neighbours(const Phyxels& phyxels) {
  Neighbours neighbours;
  neighbours.pairs = find_pairs(phyxels);
  for (const auto& [i, j] : neighbours.pairs)
    neighbours.support.push_back(pair_support(phyxels, i, j));
  neighbours.start.assign(phyxels.size() + 1, 0);
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

void join_pieces(const std::span<const std::uint32_t> pieces, Phyxels& phyxels) {
  for (std::vector<Part> parts; parts = lesser_parts(pieces, phyxels), !parts.empty();)
    for (const Part& part : parts) {
      const auto [i, j] = nearest_outside(part, pieces, phyxels.rest);
      const double support = widened * (phyxels.rest[j] - phyxels.rest[i]).norm();
      for (const auto end : {i, j})
        phyxels.support[end] = std::max(phyxels.support[end], support);
    }
}

std::vector<Sight> clear_sights(const Points& from, const Points& to, const std::span<const Pair> pairs) {
  std::vector<Sight> sights;
  sights.reserve(pairs.size());
  for (const Pair& pair : pairs)
    sights.push_back({(to[pair[1]] - from[pair[0]]).norm()});
  return sights;
}

} // namespace kerf::pba
