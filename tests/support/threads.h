#pragma once

#include "base/parallel.h"

#include <tbb/task_arena.h>

namespace kerf {

/// Calls f with loops that n threads take, also where there are fewer processors, and one again after it. (TBB's own
/// arena has no more places than processors, whatever it is allowed.)
template <class Function>
void with_threads(const int n, const Function& f) {
  set_n_threads(n);
  tbb::task_arena(n).execute(f);
  set_n_threads(1);
}

} // namespace kerf
