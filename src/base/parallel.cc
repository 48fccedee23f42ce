#include "base/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <dlfcn.h>

#include <memory>

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
