#pragma once

/// Luminance on a lattice of points, and what the 7 x 7 points around each say of it (thesis §3.4.3.3).

#include "texture/detail.h"

#include <cstddef>
#include <vector>

namespace kerf::texture {

/// The columns of a row that are asked for: first to last.
struct Span {
  int first = 0, last = -1;
};

class Windows {
 public:
  /// Points of windows are `stride` points apart; what windows reach beyond the lattice lies in a `gutter` around it.
  Windows(int width, int height, int gutter, int stride);
  /// The same for a lattice of another size. Keeps its memory.
  void reset(int width, int height);

  float& luminance(const int column, const int row) { return luminance_[index(column, row)]; }
  float luminance(const int column, const int row) const { return luminance_[index(column, row)]; }
  /// Finds mean and place along a row, from luminances that are all there.
  void find(int row, const Span& span);
  float mean(const int column, const int row) const { return mean_[inner(column, row)]; }
  /// The share of the window's values below the point's own.
  const float& place(const int column, const int row) const { return place_[inner(column, row)]; }

 private:
  std::size_t index(const int column, const int row) const {
    return static_cast<std::size_t>(row + gutter_) * (width_ + 2 * gutter_) + gutter_ + column;
  }
  std::size_t inner(const int column, const int row) const { return static_cast<std::size_t>(row) * width_ + column; }

  int width_ = 0, gutter_, stride_;
  std::vector<float> luminance_, mean_, place_;
};

} // namespace kerf::texture
