#pragma once

#include "base/archive.h"
#include "base/vec.h"

namespace kerf::cut {

/// Bits over a square around a point of a plane.
class Raster {
 public:
  static constexpr int n = 64;
  static constexpr double side = 2.5; ///< in cubes; more than a cube's space diagonal and twice the lag

  /// Sets the texels whose middles lie in a triangle, where the third coordinate is at most `most` away from 0; of
  /// coordinates in cubes, from the middle. Returns how many of them were not set.
  int draw(const std::array<Vec3, 3>& triangle, double most);
  /// All texels within a distance of set ones.
  Raster grown(double distance) const;
  int count() const;
  bool any() const { return count() > 0; }
  friend Raster operator&(Raster a, const Raster& b);

  void archive(Archive& a) { a(rows_); }

 private:
  std::array<std::uint64_t, n> rows_{};
};

} // namespace kerf::cut
