#include "base/parallel.h"

#include "base/loan.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/task_arena.h>

#include <dlfcn.h>

#include <atomic>
#include <memory>
#include <thread>

namespace kerf {

int n_processors() { return tbb::info::default_concurrency(); }

void set_n_threads(const int n) {
  // TBB's own way to say it: the limit holds as long as the object lives.
  static std::unique_ptr<tbb::global_control> limit;
  limit = nullptr;
  limit = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism, n);
}

int n_threads() {
  return static_cast<int>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
}

void parallel_ranges(const std::size_t n, const std::size_t worth,
                     const FunctionRef<void(std::size_t, std::size_t)> f) {
  if (n < worth || n_threads() == 1) {
    f(0, n);
    return;
  }
  const std::size_t grain = std::max<std::size_t>(1, n / (8 * n_threads()));
  tbb::parallel_for(
    tbb::blocked_range<std::size_t>(0, n, grain),
    [&](const tbb::blocked_range<std::size_t>& range) { f(range.begin(), range.end()); }, tbb::simple_partitioner());
}

void beside(const FunctionRef<void()> f, const FunctionRef<void()> g) {
  if (n_threads() == 1) {
    f();
    g();
    return;
  }
  tbb::parallel_invoke([&] { f(); }, [&] { g(); });
}

namespace {

using Flag = std::atomic_ref<std::uint8_t>;

/// Until another thread has set it, which it is about to do.
void wait_for(const Flag flag) {
  constexpr int most_turns = 2000; // some microseconds
  for (int turn = 0; flag.load(std::memory_order_acquire) == 0; ++turn)
    if (turn < most_turns)
      __builtin_ia32_pause();
    else
      std::this_thread::yield();
}

/// Sets a flag in the end, even where an exception is it: others wait.
struct SetInTheEnd {
  Flag flag;
  ~SetInTheEnd() { flag.store(1, std::memory_order_release); }
};

} // namespace

void Precedence::add(const std::span<const std::uint32_t> before) {
  std::uint32_t length = 1;
  for (const std::uint32_t i : before)
    length = std::max(length, length_[i] + 1);
  before_.insert(before_.end(), before.begin(), before.end());
  ends_.push_back(static_cast<std::uint32_t>(before_.size()));
  length_.push_back(length);
  longest_ = std::max(longest_, length);
}

void parallel_in_order(const Precedence& items, const FunctionRef<void(std::size_t)> f) {
  const std::size_t n = items.n();
  const auto n_workers = static_cast<std::size_t>(std::min<double>(n_threads(), items.width()));
  if (n_workers < 2) {
    for (std::size_t i = 0; i < n; ++i)
      f(i);
    return;
  }
  // Items are taken in their order: those before one are done, or a thread that has taken them is at work on them.
  Loan<std::uint8_t> is_done(n, 0);
  std::atomic<std::size_t> next = 0;
  tbb::parallel_for(
    std::size_t(0), n_workers,
    [&](std::size_t) {
      for (std::size_t i = next++; i < n; i = next++) {
        const SetInTheEnd done{Flag(is_done[i])};
        for (const std::uint32_t before : items.before(i))
          wait_for(Flag(is_done[before]));
        try {
          f(i);
        } catch (...) {
          next = n; // nothing more is begun
          throw;
        }
      }
    },
    tbb::simple_partitioner());
}

namespace {

/// Calls a function of a library, if one that is loaded has it.
void call_if_there(const char* const name, const int argument) {
  if (void* const found = dlsym(RTLD_DEFAULT, name))
    reinterpret_cast<void (*)(int)>(found)(argument);
}

} // namespace

void keep_libraries_to_one_thread() {
  call_if_there("openblas_set_num_threads", 1);
  call_if_there("omp_set_max_active_levels", 0); // regions that ask for threads themselves stay without
}

} // namespace kerf
