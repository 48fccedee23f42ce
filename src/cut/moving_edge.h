#pragma once

/// Whether a segment that moves meets a polyline that moves, so that no material slips through between edges or steps.
///
/// Method: between two places of the polyline, a segment p q and a piece a b of it, all ends moving linearly, touch
/// where D(t, s, f) = (1-t) p + t q - (1-s) a - s b = 0 with t, s and the time f in [0, 1]. D is interpolated on the
/// six tetrahedra of the unit cube that share its diagonal (Kuhn), from its eight corner values p - a, ...; the segment
/// is met once for each tetrahedron whose image holds the origin, by the exact predicates of geometry/predicates.h.
/// Cubes share whole faces: (s, f) between segments that share an end, (t, f) between pieces of the polyline, (t, s)
/// between steps. So round every closed loop of segments the number of meetings is even, unless an end of the polyline
/// is inside of it, whatever the motion: the map of the loop into space is closed. For a segment at rest this is the
/// crossing of the strip of add_strip().

#include "cut/blade.h"
#include "cut/target.h"

namespace kerf::cut {

/// How a segment that moves linearly from `before` to `now` [m] in a step meets a blade on its path through it.
Verdict meet(const BladePath& path, const Segment& before, const Segment& now);

} // namespace kerf::cut
