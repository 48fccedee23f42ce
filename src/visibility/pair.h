#pragma once

/// What this room looks at: pairs of points, and the faces of the cut that may come between them. Everything is in the
/// rest configuration.

#include "base/archive.h"
#include "base/id.h"
#include "base/vec.h"

namespace kerf::visibility {

using PairId = Id<struct PairTag>;

/// Two points that may see each other.
struct Pair {
  Vec3 a = Vec3::Zero(), b = Vec3::Zero(); ///< [m]
  double support = 0;                      ///< radius of the support of the kernel [m], > 0

  void archive(Archive& archive) { archive(a, b, support); }
};

/// A triangle of the cut, or of the skin [m]; its orientation does not matter.
using Face = std::array<Vec3, 3>;

} // namespace kerf::visibility
