#pragma once

/// A corner's row of single precision (kernels.h) in one register of any x86-64: three numbers, and one that nobody
/// looks at.

#include "fem/kernels.h"

namespace kerf::fem {

typedef float Four __attribute__((vector_size(16), may_alias));

inline Four load(const Row<float>& row) { return *reinterpret_cast<const Four*>(&row); }
inline void store(Row<float>& row, const Four& v) { *reinterpret_cast<Four*>(&row) = v; }
inline void add(Row<float>& row, const Four& v) { store(row, load(row) + v); }

} // namespace kerf::fem
