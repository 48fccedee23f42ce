#pragma once

#include "physics/crumbs.h"

#include <algorithm>

namespace kerf::physics {

/// Whether crumbs carry every particle. Then a step has nothing to solve, and costs what six numbers a crumb do.
inline bool carry_all(const Crumbs& crumbs) {
  return crumbs.any() && std::ranges::all_of(crumbs.carried(), [](const std::uint8_t is) { return is != 0; });
}

} // namespace kerf::physics
