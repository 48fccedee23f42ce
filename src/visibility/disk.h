#pragma once

/// The visibility disk of a pair of points and its mask (thesis §2.6.2 and §2.6.3).
///
/// Notation: the disk stands halfway between the points a and b, at a right angle to ab; its radius is a factor times
/// the distance |ab|. The smallest square around it has n x n texels. A texel is occluded when the broken line from a
/// to the middle of the texel to b meets a face. The mask is n words: bit x of word y is texel (x, y). Both lines reach
/// a little beyond the disk, so that a face in its plane is not lost between them to rounding.
/// In the frame of the disk a point is (X, Y, Z): X and Y from the middle in texels, Z = -1 at a, 0 in the disk and 1
/// at b.
///
/// Limit: at most 32 texels a side, the thesis's choice: a row of texels is one word.

#include "visibility/pair.h"

#include <array>
#include <cstdint>
#include <span>

namespace kerf::visibility {

/// Where the lines end, in distances of the disk from their eye [1].
constexpr double end_of_lines = 1 + 1e-6;

/// What all masks of a run have in common.
class MaskShape {
 public:
  static constexpr int max_resolution = 32;

  /// `resolution` texels a side, 4 to 32; `radius` in distances of the pair [1], > 0. Throws ParameterError.
  MaskShape(int resolution, double radius);

  int resolution() const { return resolution_; }
  double radius() const { return radius_; }

  /// The texels of the square whose middle is in the disk; words from `resolution` on are 0.
  const std::array<std::uint32_t, max_resolution>& disk() const { return disk_; }
  int n_texels() const { return n_texels_; }

 private:
  int resolution_;
  double radius_;
  std::array<std::uint32_t, max_resolution> disk_{};
  int n_texels_ = 0;
};

/// The frame of a disk: (X, Y, Z) of a point p are the products of p - middle with the three vectors.
struct Disk {
  Vec3 middle;           ///< [m]
  Vec3 to_x, to_y, to_z; ///< [texels/m], [texels/m], [1/m]
};

/// The points of the pair must be apart.
Disk make_disk(const Pair& pair, const MaskShape& shape);

/// The middle of texel (x, y) [m].
Vec3 texel_middle(const Disk& disk, const MaskShape& shape, int x, int y);

/// Around all lines a -> disk -> b.
Box box_of_lines(const Pair& pair, const MaskShape& shape);

/// Seen from a (side = 0) or b (side = 1), may the face occlude a texel? No when it is behind the eye, behind the disk,
/// or beyond one of the four sides of the square.
bool may_occlude(const Disk& disk, const MaskShape& shape, const Face& face, int side);

/// The texels that are set in a mask.
int count(std::span<const std::uint32_t> mask);

} // namespace kerf::visibility
