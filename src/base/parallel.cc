#include "base/parallel.h"

#include <omp.h>

namespace kerf {

void set_n_threads(const int n) { omp_set_num_threads(n); }

int n_threads() { return omp_get_max_threads(); }

} // namespace kerf
