#include "fem/level_elements.h"

#include "base/parallel.h"
#include "fem/coarse_elements.h"

#include <algorithm>

namespace kerf::fem {

namespace {

constexpr std::uint32_t none = CellsOfLevel::unused;

/// The copy that had just these children. They come in the same order then and now: that of the lowest finest copy in
/// each.
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
  const Children& children = coarsening.children;
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
  parallel_for(
    n,
    [&](const std::size_t c) {
      const auto of = children.of(c);
      coarse.n_children[c] = static_cast<std::uint8_t>(of.size());
      const bool is_full =
        of.size() == 8 && std::ranges::all_of(of, [&](const auto child) { return fine.kind[child] == Kind::full; });
      coarse.kind[c] = is_full ? Kind::full : Kind::partial;
      coarse.same_as[c] = before ? same_before(of, *before) : none;
    },
    1024);
  std::vector<std::uint32_t> partial;
  for (std::uint32_t c = 0; c < n; ++c) {
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
