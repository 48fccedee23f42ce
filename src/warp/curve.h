#pragma once

/// Closed curves, and which points of two of them belong together.

#include "base/vec.h"

#include <vector>

namespace kerf::warp {

/// A closed polygon [pixels]; its last point is followed by the first.
using Curve = std::vector<Vec2>;

/// Positive where the curve turns from the first axis to the second.
double area_of(const Curve& curve);

/// Of what a curve bounds: its middle, and the mean square of what lies how far from it, direction by direction.
struct Moments {
  Vec2 mean;
  Mat2 spread; ///< mean of (p - mean)(p - mean)^T
};
Moments moments_of(const Curve& curve);

/// n points at equal steps along a curve, the first of them its first.
Curve equally_spaced(const Curve& curve, int n);

/// How far the points of one curve lie from another.
struct Gap {
  double mean = 0, largest = 0;
};
Gap gap(const Curve& from, const Curve& to);

/// For each point of `from`, by number, the point of `to` that belongs to it, once around in the same sense: near it,
/// with the curve in the same direction, in steps that vary little. Both curves are equally spaced and turn in the same
/// sense; `to` has a multiple of the points of `from`. Units do not count. The least sum over all such matches that
/// begin where the best match without a bound end does (dynamic programming).
std::vector<int> partners(const Curve& from, const Curve& to);

} // namespace kerf::warp
