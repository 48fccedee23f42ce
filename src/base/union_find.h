#pragma once

/// Disjoint sets of 0 .. n - 1. The root of a set is its smallest member, so results do not depend on the order of
/// unions.

#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace kerf {

class UnionFind {
 public:
  explicit UnionFind(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0u); }

  std::uint32_t root(std::uint32_t i) {
    for (;;) {
      const std::uint32_t up = parent_[i], next = parent_[up];
      if (up == next)
        return up;
      i = parent_[i] = next;
    }
  }

  /// Returns the root of both.
  std::uint32_t unite(const std::uint32_t a, const std::uint32_t b) {
    std::uint32_t low = root(a), high = root(b);
    if (low > high)
      std::swap(low, high);
    parent_[high] = low;
    return low;
  }

  /// Numbers the sets from 0 in the order of their smallest members; returns how many there are.
  std::uint32_t number(std::vector<std::uint32_t>& set_of) {
    set_of.resize(parent_.size());
    std::uint32_t n_sets = 0;
    for (std::uint32_t i = 0; i < parent_.size(); ++i) {
      const std::uint32_t r = root(i);
      set_of[i] = r == i ? n_sets++ : set_of[r];
    }
    return n_sets;
  }

 private:
  std::vector<std::uint32_t> parent_;
};

} // namespace kerf
