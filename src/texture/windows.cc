#include "texture/windows.h"

namespace kerf::texture {

// Eight points at a time go beyond the last row's end.
Windows::Windows(const int width, const int height, const int gutter, const int stride)
  : width_(width),
    gutter_(gutter),
    stride_(stride),
    luminance_(static_cast<std::size_t>(width + 2 * gutter) * (height + 2 * gutter) + n_lanes),
    mean_(static_cast<std::size_t>(width) * height + n_lanes),
    place_(mean_.size()) {}

void Windows::find(const int row, const Span& span) {
  for (int c = span.first; c <= span.last; c += n_lanes)
    find_windows(&luminance_[index(c, row)], width_ + 2 * gutter_, stride_, &mean_[inner(c, row)],
                 &place_[inner(c, row)]);
}

} // namespace kerf::texture
