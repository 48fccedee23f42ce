#pragma once

/// What a body is at rest, and how it is cut: the one thing that whoever cuts, places, draws or moves it looks at. Its
/// surface stands beside it, one room up (surface/surface.h): that is made from it.

#include "grid/complex.h"

namespace kerf::grid {

struct Solid {
  Grid grid;
  Cuts cuts;
  CellComplex complex = {};
};

} // namespace kerf::grid
