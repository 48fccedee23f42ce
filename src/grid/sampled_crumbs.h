#pragma once

/// Crumbs (crumbs.h) of a body that its physics knows by *samples*, points of its own. A piece that a cut has left is a crumb
/// too where its samples span no volume: they are none, up to three, or all near one plane, with a second moment about
/// their mean of less than h^2 / 8 along some direction. What they do tells no deformation gradient.

#include "base/vec.h"
#include "grid/crumbs.h"

namespace kerf::grid {

/// As update_crumbs(). `samples`: where they rest [m].
void update_crumbs(Solid& solid, CutChange& change, const Points& samples);

} // namespace kerf::grid
