#pragma once

/// What a cut leaves of the bond between two points.

#include "base/archive.h"

namespace kerf::pba {

/// The weight of a pair of points is factor * kernel(distance, support). Diffraction and transparency lengthen the
/// distance (thesis, equations 2.34 and 2.35), visibility makes the factor 0, extended visibility anything from 1 down
/// to 0 (equation 2.39).
struct Sight {
  double distance = 0; ///< rest configuration [m]
  double factor = 1;   ///< in [0, 1] [1]

  bool operator==(const Sight&) const = default;
  void archive(Archive& a) { a(distance, factor); }
};

} // namespace kerf::pba
