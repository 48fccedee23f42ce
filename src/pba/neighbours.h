#pragma once

/// Which points count for which. The support of a pair of phyxels is the mean of their own (Mueller and others 2004
/// take that of the one that asks), so that a pair has one weight and one sight, whoever asks.

#include "pba/phyxels.h"
#include "pba/sight.h"

#include <array>
#include <span>

namespace kerf::pba {

/// Two points: of one set, the lower first, or of two sets, one each.
using Pair = std::array<std::uint32_t, 2>;

/// The neighbours of phyxel i: at start[i] .. start[i + 1].
struct Neighbours {
  std::vector<std::uint32_t> start;
  std::vector<std::uint32_t> phyxel; ///< ascending within each range
  std::vector<std::uint32_t> pair;   ///< in `pairs`
  std::vector<Pair> pairs;           ///< each once, ascending
  std::vector<double> support;       ///< of each pair [m]
};

/// All pairs of phyxels closer than the mean of their supports.
Neighbours find_neighbours(const Phyxels& phyxels);

/// The neighbours that these pairs of `n` phyxels make, ascending; without supports.
Neighbours neighbours_of(std::vector<Pair> pairs, std::size_t n);

/// The sights of pairs (one of `from`, one of `to`) with nothing between them [m].
std::vector<Sight> clear_sights(const Points& from, const Points& to, std::span<const Pair> pairs);

} // namespace kerf::pba
