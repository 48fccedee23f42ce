#include "texture/windows.h"

namespace kerf::texture {

Windows::Windows(const int width, const int height, const int gutter, const int stride)
  : gutter_(gutter), stride_(stride) {
  reset(width, height);
}

void Windows::reset(const int width, const int height) {
  width_ = width;
  // Eight points at a time go beyond the last row's end.
  luminance_.assign(static_cast<std::size_t>(width + 2 * gutter_) * (height + 2 * gutter_) + n_lanes, 0);
  mean_.assign(static_cast<std::size_t>(width) * height + n_lanes, 0);
  place_.assign(mean_.size(), 0);
}

void Windows::find(const int row, const Span& span) {
  for (int c = span.first; c <= span.last; c += n_lanes)
    find_windows(&luminance_[index(c, row)], width_ + 2 * gutter_, stride_, &mean_[inner(c, row)],
                 &place_[inner(c, row)]);
}

} // namespace kerf::texture
