#pragma once

/// Masks by OpenGL, the way of thesis §2.6.3: each face is drawn into the square of a disk as seen from either point,
/// with the far plane in the middle between them; a fragment that lands on an occluded texel is discarded, so what is
/// written are newly occluded texels. Many disks are the tiles of one image, drawn by one call. The written texels are
/// read back and added to the masks, whose bits are counted; occlusion queries, which the thesis counts with, cost a
/// draw call for each disk.
///
/// Limits: what is nearer to an eye than 1/1000 of its distance from the disk is not drawn; edges are snapped to the
/// rasteriser's sub-pixels. So some texels differ from those of the processor, which are the definition: 4 to 5 in 10^5
/// of random faces.

#include "visibility/rasteriser.h"

#include <memory>

namespace kerf::visibility {

class GlRasteriser : public Rasteriser {
 public:
  /// Makes a GL context; throws DataError if there is none.
  GlRasteriser();
  ~GlRasteriser() override;

  void occlude(const MaskShape& shape, std::span<const Face> faces, std::span<const DiskUpdate> updates) override;

  /// The texels that the last call newly occluded.
  std::size_t n_written() const { return n_written_; }

 private:
  struct Atlas;
  std::unique_ptr<Atlas> atlas_;
  std::size_t n_written_ = 0;
};

} // namespace kerf::visibility
