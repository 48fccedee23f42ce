#pragma once

/// Masks by the processor.
///
/// Method: seen from an eye, a corner of a face is v = (X, Y, W) with W = 1 + Z from a and 1 - Z from b, and the line
/// to texel (x, y) has the direction t = (x, y, 1) and ends at W = end, just beyond 1. With the corners in the order
/// that makes D = v_0 . (v_1 x v_2) > 0, the line meets the face when the three edge functions e_k = t . (v_k x v_k+1)
/// are >= 0 and e_0 + e_1 + e_2 >= D / end: it pierces the cone over the face, and does so before it ends. All four are
/// linear in x and y, so each bounds x from one side in every row: no clipping, not even for faces around the eye. The
/// rows are the lanes of the vectors.
/// Notation: from the frame of disk.h. Rounding: bounds are found in double precision and evaluated along the rows in
/// single. The edge that two faces share bounds both at the same place, bit by bit, so a seam has no hole; this needs
/// products that are not contracted with sums.
/// Source: thesis §2.6.3; Olano and Greer, Triangle scan conversion using 2D homogeneous coordinates, 1997.
/// Limit: a face in whose plane the eye lies, or without area, occludes nothing.

#include "visibility/rasteriser.h"

namespace kerf::visibility {

class CpuRasteriser : public Rasteriser {
 public:
  void occlude(const MaskShape& shape, std::span<const Face> faces, std::span<const DiskUpdate> updates) override;
};

} // namespace kerf::visibility
