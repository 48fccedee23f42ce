#pragma once

/// The colours of an image.

#include "base/vec.h"

namespace kerf::render {

/// sRGB colours, each component in [0, 1].
struct Look {
  Vec3 skin = {0.53, 0.22, 0.17};
  Vec3 revealed = {0.92, 0.58, 0.54};       ///< faces revealed by the first cut
  Vec3 revealed_other = {0.93, 0.66, 0.52}; ///< later cuts lie between this and `revealed`, neighbours well apart
  Vec3 blade = {0.74, 0.76, 0.79};
  Vec3 background_top = {0.96, 0.965, 0.97};
  Vec3 background_bottom = {0.82, 0.83, 0.845};

  /// The colour of faces with label k: 0 skin, k > 0 revealed by cut k.
  Vec3 colour(int label) const;
};

} // namespace kerf::render
