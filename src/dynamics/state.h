#pragma once

/// What a body's past amounts to. A stepper may be thrown away and made again from it, after a cut or a restart.

#include "base/vec.h"

#include <span>

namespace kerf::dynamics {

struct State {
  Points x;        ///< current corner positions [m]
  Points v;        ///< corner velocities [m/s]
  double time = 0; ///< [s]
};

/// The 3 n numbers of n points.
inline std::span<double> flat(Points& p) { return {p.empty() ? nullptr : p[0].data(), 3 * p.size()}; }
inline std::span<const double> flat(const Points& p) { return {p.empty() ? nullptr : p[0].data(), 3 * p.size()}; }

} // namespace kerf::dynamics
