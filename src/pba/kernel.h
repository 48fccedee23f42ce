#pragma once

/// The weight of a pair of points: how much one counts for the other. w(r, h) = (1 - (r / h)^2)^3 inside the support h,
/// zero beyond: the kernel of Mueller, Keiser, Nealen, Pauly, Gross and Alexa 2004 without its factor
/// 315 / (64 pi h^3), of which moving least squares are independent. What stands between two points is told by their
/// sight (thesis §2.3.1): it lengthens the distance, or takes a part of the weight, or both.

#include "pba/sight.h"

namespace kerf::pba {

/// Weight [1] at a distance [m], for a support [m].
inline double kernel(const double distance, const double support) {
  if (!(distance < support))
    return 0;
  const double rest = 1 - (distance / support) * (distance / support);
  return rest * rest * rest;
}

inline double weight(const Sight& sight, const double support) {
  return sight.factor * kernel(sight.distance, support);
}

} // namespace kerf::pba
