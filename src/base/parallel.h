#pragma once

/// Loops over independent items, and work side by side. Each writes only its own results, so any number of threads gives
/// the same bits.

#include "base/function_ref.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace kerf {

/// Processors that this process may run on: what taskset, a container or a cluster leave it.
int n_processors();

/// Sets the number of threads of every later loop.
void set_n_threads(int n);
int n_threads();

/// Calls f(begin, end) for ranges that cover 0 .. n - 1, on several threads when there are at least `worth` items.
void parallel_ranges(std::size_t n, std::size_t worth, FunctionRef<void(std::size_t, std::size_t)> f);

/// Calls f(i) for each i < n. Fewer than `worth` items are not worth a second thread.
template <class Function>
void parallel_for(const std::size_t n, const Function& f, const std::size_t worth = 2) {
  parallel_ranges(n, worth, [&f](const std::size_t begin, const std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      f(i);
  });
}

/// Calls both, on two threads where there are. Both may start loops of several threads; neither may wait for the
/// other, nor hold a lock across a loop, as its thread may take up the other one there.
void beside(FunctionRef<void()> f, FunctionRef<void()> g);

/// Makes one vector the other, in the memory that it has.
template <class T>
void copy(const std::vector<T>& from, std::vector<T>& to) {
  constexpr std::size_t worth = 65536 / sizeof(T); // values
  to.resize(from.size());
  parallel_ranges(from.size(), worth, [&](const std::size_t begin, const std::size_t end) {
    std::copy(from.begin() + static_cast<std::ptrdiff_t>(begin), from.begin() + static_cast<std::ptrdiff_t>(end),
              to.begin() + static_cast<std::ptrdiff_t>(begin));
  });
}

/// What must be done before what (a precedence graph).
class Precedence {
 public:
  /// An item after all others, for which it need not wait but for those in `before`.
  void add(std::span<const std::uint32_t> before);

  std::size_t n() const { return ends_.size(); }
  /// What item i waits for, each less than i.
  std::span<const std::uint32_t> before(const std::size_t i) const {
    const std::size_t begin = i == 0 ? 0 : ends_[i - 1];
    return std::span(before_).subspan(begin, ends_[i] - begin);
  }
  /// How many items can be worked on at once, on average, by as many threads as one likes.
  double width() const { return n() == 0 ? 0 : double(n()) / longest_; }

 private:
  std::vector<std::uint32_t> ends_, before_;
  std::vector<std::uint32_t> length_; // of the longest chain that ends with an item
  std::uint32_t longest_ = 0;
};

/// Calls f(i) for each item, on several threads and from the first on, but not until all that it comes after are done.
/// f must not start loops of several threads itself: its thread could be given an item that waits for this one.
void parallel_in_order(const Precedence& items, FunctionRef<void(std::size_t)> f);

/// Keeps what libraries do for the calling thread to that thread: BLAS (OpenBLAS) and what has OpenMP inside (CHOLMOD).
/// Our loops are parallel already; threads beside theirs wait for each other, on a busy machine six times as long as
/// the work takes, and one thread gives the same bits everywhere.
void keep_libraries_to_one_thread();

} // namespace kerf
