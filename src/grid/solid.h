#pragma once

/// What a body is at rest, and how it is cut: the one thing that whoever cuts, places, draws or moves it looks at. Its
/// surface stands beside it, one room up (surface/surface.h): that is made from it.

#include "grid/complex.h"
#include "grid/crumbs.h"

namespace kerf::grid {

struct Solid {
  Grid grid;
  Cuts cuts;
  CellComplex complex = {};
  Crumbs crumbs = {}; ///< pieces that are too small to be deformed

  /// All but the grid, which is the mesh's.
  void archive(Archive& a) {
    a.name("solid");
    a(cuts, complex, crumbs);
  }
};

} // namespace kerf::grid
