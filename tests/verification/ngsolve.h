#pragma once

/// NGSolve (Schoeberl 2014), an independent program: a Python package (`pip install ngsolve`), of the `python3` that
/// PATH names.

namespace kerf::verification::ngsolve {

bool is_installed();

struct Tip {
  double value = 0;   ///< [m]
  double seconds = 0; ///< of the processor: mesh, assembly, solution [s]
};

/// The tip of verification::heavy_cantilever on cubes of one order (ngsolve_beam.py). Throws std::runtime_error when
/// NGSolve fails.
Tip heavy_cantilever(int n_over_height, int order);

} // namespace kerf::verification::ngsolve
