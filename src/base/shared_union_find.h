#pragma once

/// Disjoint sets of 0 .. n - 1, as in union_find.h, that several threads unite at once: a set's root is its smallest
/// member then too, so nothing that is asked for afterwards depends on threads. Without locks (Anderson and Woll 1991,
/// Wait-free parallel algorithms for the union-find problem): only roots are linked, by comparison and exchange, each
/// to a smaller one.

#include "base/loan.h"
#include "base/parallel.h"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <utility>
#include <vector>

namespace kerf {

class SharedUnionFind {
 public:
  explicit SharedUnionFind(const std::size_t n) : parent_(n, AnyValues()) {
    for_each_block([&](const std::uint32_t i, std::size_t) { parent_[i] = i; });
  }

  /// Which is the smallest member's own, once all are united.
  std::uint32_t root(std::uint32_t i) {
    for (;;) {
      const std::uint32_t up = load(i), next = load(up);
      if (up == next)
        return up;
      std::atomic_ref(parent_[i]).store(next, std::memory_order_relaxed); // i is no root, and never will be again
      i = next;
    }
  }

  /// Returns a member of both, most often their root.
  std::uint32_t unite(std::uint32_t a, std::uint32_t b) {
    for (;;) {
      a = root(a);
      b = root(b);
      if (a == b)
        return a;
      if (a > b)
        std::swap(a, b);
      std::uint32_t expected = b;
      if (std::atomic_ref(parent_[b]).compare_exchange_weak(expected, a, std::memory_order_relaxed))
        return a;
    }
  }

  /// Numbers the sets from 0 in the order of their smallest members, those of members alone that `counts(i)`; a set of
  /// which one counts must have all counted. Returns how many there are.
  template <class Counts>
  std::uint32_t number(std::vector<std::uint32_t>& set_of, const std::uint32_t otherwise, const Counts& counts) {
    set_of.resize(parent_.size());
    Loan<std::uint32_t> first(n_blocks() + 1, 0); // number of each block
    const auto is_first = [&](const std::uint32_t i) { return load(i) == i && counts(i); };
    for_each_block([&](const std::uint32_t i, const std::size_t block) { first[block + 1] += is_first(i) ? 1 : 0; });
    for (std::size_t block = 0; block < n_blocks(); ++block)
      first[block + 1] += first[block];
    const std::uint32_t n_sets = first[n_blocks()];
    for_each_block([&](const std::uint32_t i, const std::size_t block) {
      set_of[i] = is_first(i) ? first[block]++ : otherwise;
    });
    for_each_block([&](const std::uint32_t i, std::size_t) {
      if (load(i) != i && counts(i))
        set_of[i] = set_of[root(i)];
    });
    return n_sets;
  }
  std::uint32_t number(std::vector<std::uint32_t>& set_of) {
    return number(set_of, 0, [](std::uint32_t) { return true; });
  }

 private:
  static constexpr std::size_t block_size = 4096, worth_blocks = 3; // from which on a second thread pays

  std::size_t n_blocks() const { return (parent_.size() + block_size - 1) / block_size; }
  template <class Function>
  void for_each_block(const Function& f) {
    parallel_for(
      n_blocks(),
      [&](const std::size_t block) {
        const std::size_t end = std::min(parent_.size(), (block + 1) * block_size);
        for (std::size_t i = block * block_size; i < end; ++i)
          f(static_cast<std::uint32_t>(i), block);
      },
      worth_blocks);
  }
  std::uint32_t load(const std::uint32_t i) {
    return std::atomic_ref(parent_[i]).load(std::memory_order_relaxed);
  }

  Loan<std::uint32_t> parent_;
};

} // namespace kerf
