#include "render/look.h"

#include <cmath>

namespace kerf::render {

Vec3 Look::colour(int label) const {
  if (label == 0)
    return skin;
  // Multiples of the golden ratio: cuts that follow each other differ clearly, and no two are the same.
  const double golden = 0.6180339887498949;
  const double fraction = std::fmod((label - 1) * golden, 1.0);
  return (1 - fraction) * revealed + fraction * revealed_other;
}

} // namespace kerf::render
