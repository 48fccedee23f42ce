#pragma once

/// Who fills the masks: the processor, which defines them (cpu_rasteriser.h), or OpenGL (gl_rasteriser.h).

#include "visibility/disk.h"

namespace kerf::visibility {

/// One disk to bring up to date.
struct DiskUpdate {
  Disk disk;
  std::span<const std::uint32_t> faces; ///< which faces may newly occlude it
  std::uint32_t* mask = nullptr;        ///< its words, one a row of texels
};

class Rasteriser {
 public:
  virtual ~Rasteriser() = default;

  /// Sets in the mask of each update the texels of its disk that its faces occlude; what is set stays set. No two
  /// updates share a mask.
  virtual void occlude(const MaskShape& shape, std::span<const Face> faces, std::span<const DiskUpdate> updates) = 0;
};

} // namespace kerf::visibility
