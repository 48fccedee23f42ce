#include "image/image.h"

namespace kerf::image {

Grey luminance(const Colours& colours) {
  Grey grey(colours.width, colours.height, 0);
  for (std::size_t i = 0; i < colours.values.size(); ++i)
    grey.values[i] = luminance(colours.values[i]);
  return grey;
}

} // namespace kerf::image
