#pragma once

/// Loops over independent items. Each item writes only its own results, so any number of threads gives the same bits.

#include <cstddef>

namespace kerf {

/// Sets the number of threads of every later loop.
void set_n_threads(int n);
int n_threads();

/// Fewer items than `worth` run on one thread: starting a second costs more than it brings.
template <class Function>
void parallel_for(std::size_t n, const Function& f, const std::size_t worth = 1) {
#pragma omp parallel for schedule(static) if (n > worth)
  for (std::size_t i = 0; i < n; ++i)
    f(i);
}

} // namespace kerf
