#pragma once

/// What a tool looks like where its scene does not say: so that pictures show every tool. Nothing but pictures depends
/// on it.

#include "cut/scissors.h"
#include "scene/world.h"

namespace kerf::scene {

/// From the edge of a blade to its back, blade frame [m]: against its first motion across the edge, a fifth of the edge
/// long; anywhere across the edge of a blade that never moves across it. cut::check() must accept the blade.
Vec3 usual_spine(const cut::Blade& blade);

/// The same of the first blade of scissors, tool frame [m]: to the side that it opens to, a tenth of its edge long.
Vec3 usual_spine(const cut::Scissors& scissors);

/// Gives forceps jaws and a handle, where they have none: as far apart as what they hold at rest reaches, and away from
/// the body that it belongs to.
void complete_shape(Forceps& forceps, const World& world, double grip_time);

} // namespace kerf::scene
