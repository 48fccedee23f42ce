#include "pba/links.h"

#include "base/parallel.h"
#include "pba/reach.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>

namespace kerf::pba {

namespace {

using grid::CopyId;

/// Fewest faces between two cells of a full grid.
int n_faces(const grid::Grid& grid, const grid::CellId a, const grid::CellId b) {
  const Vec3 steps = (grid.origin(a) - grid.origin(b)) / grid.h();
  return static_cast<int>(std::lround(steps.cwiseAbs().sum()));
}

/// The copies within `radius` of p [m], in the copy `from`, to which ways lead that are no longer than in a full grid.
std::vector<CopyId> copies_around(const grid::Solid& solid, const CopyId from, const Vec3& p, const double radius) {
  constexpr int detour = 2; // faces more, as around a dent in the skin
  const auto& copies = solid.complex.copies;
  const auto is_near = [&](const CopyId c) {
    const Vec3 lower = solid.grid.origin(copies[c].cell);
    return (p.cwiseMax(lower).cwiseMin(lower + Vec3::Constant(solid.grid.h())) - p).norm() < radius;
  };
  std::map<CopyId, int> steps = {{from, 0}};
  std::vector<CopyId> found = {from};
  for (std::size_t next = 0; next < found.size(); ++next) {
    const int n = steps[found[next]] + 1;
    for_each_glued(solid, CopyId(found[next]), [&](const CopyId other) {
      if (n <= n_faces(solid.grid, copies[from].cell, copies[other].cell) + detour && is_near(other) &&
          steps.try_emplace(other, n).second)
        found.push_back(other);
    });
  }
  std::sort(found.begin(), found.end());
  return found;
}

} // namespace

std::vector<std::vector<CopyId>> reached_copies(const grid::Solid& solid, const Phyxels& phyxels,
                                                const std::span<const CopyId> copies) {
  constexpr std::size_t worth = 256; // phyxels from which on a second thread pays
  std::vector<std::vector<CopyId>> reached(phyxels.size());
  parallel_for(
    phyxels.size(),
    [&](const std::size_t i) {
      if (copies[i].valid())
        reached[i] = copies_around(solid, copies[i], phyxels.rest[i], phyxels.support[i]);
    },
    worth);
  return reached;
}

Neighbours reached_neighbours(const Phyxels& phyxels, const std::span<const CopyId> copies,
                              const std::span<const std::vector<CopyId>> reached) {
  Neighbours all = find_neighbours(phyxels);
  const auto reaches = [&](const std::uint32_t i, const std::uint32_t j) {
    return std::binary_search(reached[i].begin(), reached[i].end(), copies[j]);
  };
  std::vector<Pair> pairs;
  std::vector<double> support;
  for (std::size_t p = 0; p < all.pairs.size(); ++p)
    if (const auto [i, j] = all.pairs[p]; reaches(i, j) || reaches(j, i)) {
      pairs.push_back({i, j});
      support.push_back(all.support[p]);
    }
  Neighbours kept = neighbours_of(std::move(pairs), phyxels.size());
  kept.support = std::move(support);
  return kept;
}

NodePairs reached_node_pairs(const grid::Solid& solid, const Phyxels& phyxels,
                             const std::span<const std::vector<CopyId>> reached) {
  std::vector<std::vector<grid::NodeId>> nodes(phyxels.size()); // that each reaches
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    for (const CopyId c : reached[i])
      for (unsigned left = solid.complex.copies[c].nodes; left != 0; left &= left - 1)
        nodes[i].push_back(solid.grid.nodes(solid.complex.copies[c].cell)[std::countr_zero(left)]);
    std::sort(nodes[i].begin(), nodes[i].end());
  }
  NodePairs all = find_node_pairs(solid.grid, phyxels);
  std::vector<Pair> pairs;
  std::vector<double> support;
  for (std::size_t p = 0; p < all.pairs.size(); ++p)
    if (const auto [row, i] = all.pairs[p]; std::binary_search(nodes[i].begin(), nodes[i].end(), all.nodes[row])) {
      pairs.push_back({row, i});
      support.push_back(all.support[p]);
    }
  all.pairs = std::move(pairs);
  all.support = std::move(support);
  return all;
}

std::vector<Link> find_links(const grid::Solid& solid, const Points& rest, const std::span<const CopyId> copies) {
  const double h = solid.grid.h();
  const auto ways = shortest_ways(solid, rest, copies);
  std::map<Pair, Link> links;
  const auto add = [&](Pair pair, const double length, const double narrowest) {
    if (pair[0] > pair[1])
      std::swap(pair[0], pair[1]);
    Link& link = links.try_emplace(pair, Link{pair, length, 0}).first->second;
    link.length = std::min(link.length, length);
    link.area += narrowest * h * h;
  };
  for (std::uint32_t i = 0; i < copies.size(); ++i) // beside the phyxel of their copy
    if (copies[i].valid())
      if (const Way& way = ways[copies[i]]; way.phyxel != i)
        add({way.phyxel, i}, (rest[i] - rest[way.phyxel]).norm(), way.narrowest);
  for (const auto c : ids<CopyId>(ways.size()))
    for_each_glued(solid, c, [&](const CopyId other) {
      const Way &a = ways[c], &b = ways[other];
      if (c < other && a.phyxel != b.phyxel && a.phyxel != no_phyxel && b.phyxel != no_phyxel)
        add({a.phyxel, b.phyxel}, a.length + b.length + h, std::min(a.narrowest, b.narrowest));
    });
  std::vector<Link> sorted;
  for (const auto& [pair, link] : links)
    sorted.push_back(link);
  std::stable_sort(sorted.begin(), sorted.end(), [](const Link& a, const Link& b) { return a.length < b.length; });
  return sorted;
}

} // namespace kerf::pba
