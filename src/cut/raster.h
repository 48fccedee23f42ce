#pragma once

#include "base/archive.h"
#include "base/function_ref.h"
#include "base/vec.h"

#include <bit>

namespace kerf::cut {

/// Bits over a square around a point of a plane.
class Raster {
 public:
  static constexpr int n = 64;
  static constexpr double side = 2.5; ///< in cubes; more than a cube's space diagonal and twice the lag of elements (the
                                     ///< corners of the largest sections miss a part of that of springs)

  /// Sets the texels whose middles lie in a triangle, where the third coordinate is at most `most` away from 0; of
  /// coordinates in cubes, from the middle. Returns how many of them were not set.
  int draw(const std::array<Vec3, 3>& triangle, double most);
  /// All texels within a distance of set ones, which is distance(x, y) in that direction and at most `most`.
  Raster grown(FunctionRef<double(double, double)> distance, double most) const;
  int count() const;
  /// Calls f(x, y) for the middles of set texels [cubes].
  template <class Function>
  void for_each(const Function& f) const {
    for (int j = 0; j < n; ++j)
      for (std::uint64_t left = rows_[j]; left != 0; left &= left - 1)
        f(middle(std::countr_zero(left)), middle(j));
  }
  bool any() const { return count() > 0; }
  friend Raster operator&(Raster a, const Raster& b);

  void archive(Archive& a) { a(rows_); }

 private:
  static constexpr double middle(const int i) { return ((i + 0.5) / n - 0.5) * side; }

  std::array<std::uint64_t, n> rows_{};
};

} // namespace kerf::cut
