#include "fem/level_elements.h"

#include "base/parallel.h"
#include "fem/coarse_elements.h"

#include <algorithm>
#include <numeric>

namespace kerf::fem {

namespace {

constexpr std::uint32_t none = CellsOfLevel::unused;

/// Fine copies by their parents, ascending.
struct Children {
  std::vector<std::uint32_t> begin, all;

  Children(const std::span<const std::uint32_t> parent, const std::size_t n_coarse) : begin(n_coarse + 1, 0) {
    for (const std::uint32_t p : parent)
      if (p != none)
        ++begin[p + 1];
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    all.resize(begin[n_coarse]);
    std::vector<std::uint32_t> end(begin.begin(), begin.end() - 1);
    for (std::uint32_t c = 0; c < parent.size(); ++c)
      if (parent[c] != none)
        all[end[parent[c]]++] = c;
  }
  std::span<const std::uint32_t> of(const std::size_t coarse) const {
    return std::span(all).subspan(begin[coarse], begin[coarse + 1] - begin[coarse]);
  }
};

/// The copy that had just these children. They come in the same order then and now: that of the lowest finest copy in each.
std::uint32_t same_before(const std::span<const std::uint32_t> children, const CoarseBefore& before) {
  std::uint32_t parent = none;
  for (const std::uint32_t child : children) {
    const std::uint32_t was = before.same_child[child];
    if (was == none || (parent != none && before.parent[was] != parent))
      return none;
    parent = before.parent[was];
  }
  return parent != none && before.elements.n_children[parent] == children.size() ? parent : none;
}

} // namespace

LevelElements coarse_elements(const Coarsening& coarsening, const FineElements& fine, const double h,
                              const material::Elastic& material, const CoarseBefore* const before) {
  const std::size_t n = coarsening.coarse.n_copies();
  const Children children(coarsening.parent, n);
  LevelElements coarse{{}, std::vector<Kind>(n),         std::vector<std::uint32_t>(n),
                       {}, std::vector<std::uint8_t>(n), std::vector<std::uint32_t>(n, none)};
  if (before) {
    coarse.full = before->elements.full;
  } else {
    std::vector<Child> eight;
    for (int octant = 0; octant < 8; ++octant)
      eight.push_back({&fine.full, octant});
    coarse.full = coarse_element(eight, h, material);
  }
  std::vector<std::uint32_t> partial;
  for (std::uint32_t c = 0; c < n; ++c) {
    const auto of = children.of(c);
    coarse.n_children[c] = static_cast<std::uint8_t>(of.size());
    const bool is_full =
      of.size() == 8 && std::ranges::all_of(of, [&](const auto child) { return fine.kind[child] == Kind::full; });
    coarse.kind[c] = is_full ? Kind::full : Kind::partial;
    coarse.same_as[c] = before ? same_before(of, *before) : none;
    coarse.which[c] = static_cast<std::uint32_t>(partial.size());
    if (coarse.kind[c] == Kind::partial)
      partial.push_back(c);
  }
  coarse.made.resize(partial.size());
  parallel_for(
    partial.size(),
    [&](const std::size_t i) {
      if (const std::uint32_t same = coarse.same_as[partial[i]]; same != none) {
        coarse.made[i] = before->elements.made[before->elements.which[same]];
        return;
      }
      std::vector<Child> of;
      for (const std::uint32_t child : children.of(partial[i]))
        of.push_back({&fine.element(child), coarsening.octant[child]});
      coarse.made[i] = std::make_shared<const Element>(coarse_element(of, h, material));
    },
    64);
  return coarse;
}

} // namespace kerf::fem
