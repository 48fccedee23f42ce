#pragma once

/// Curved cutting edges, so that nobody has to write forty points.
///
/// Method: three points lie on one circle, and give its arc from the first through the second to the third; two more
/// points continue with the next arc. An arc becomes segments that turn by at most 5 degrees, so the polyline strays
/// from it by less than a thousandth of its radius. Three points on a line, in order, give a straight segment.

#include "base/vec.h"

namespace kerf::cut {

/// The polyline of a chain of arcs [m]: through points 1 2 3, then 3 4 5, and so on. Throws ParameterError at the path
/// "Edge [m]": fewer than three points or an even number, points of an arc that are the same or not finite, or on a
/// line but not in order.
Points arcs(const Points& points);

} // namespace kerf::cut
