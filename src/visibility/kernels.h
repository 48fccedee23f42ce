#pragma once

/// The inner loops of the masks, on plain pointers, compiled for several instruction sets and chosen at run time.

#include <cstddef>
#include <cstdint>

namespace kerf::visibility {

/// One disk, and what may occlude it; see disk.h and cpu_rasteriser.h for the frame.
struct DiskBlock {
  const double* frame;         ///< middle, to_x, to_y, to_z: 4 x 3
  const double* faces;         ///< 9 a face: its three corners [m]
  const std::uint32_t* which;  ///< indices of faces
  std::size_t n;               ///< how many indices
  const std::uint32_t* inside; ///< 32 words: the texels of the disk
  int resolution;              ///< texels a side
  double end;                  ///< of the lines, in distances of the disk from their eye
};

/// Sets the occluded texels in the `resolution` words of the mask.
void occlude_disk(const DiskBlock& block, std::uint32_t* mask);

} // namespace kerf::visibility
