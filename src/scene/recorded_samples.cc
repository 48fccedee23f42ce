#include "scene/recorded_samples.h"

namespace kerf::scene {

output::Colours RecordedSamples::append(const texture::Atlas& atlas) {
  const auto& first = atlas.first();
  first_.resize(first.size(), texture::Atlas::none);
  output::Colours colours;
  for (std::size_t t = 0; t < first.size(); ++t) {
    if (first[t] == texture::Atlas::none)
      first_[t] = texture::Atlas::none;
    else if (atlas.fill_of()[t] > fill_) {
      const auto begin = static_cast<std::ptrdiff_t>(first[t]);
      const auto end = begin + static_cast<std::ptrdiff_t>(texture::n_samples(atlas.parts()[t]));
      const auto append = [&](const auto& samples, auto& rows) {
        if (!samples.empty())
          rows.insert(rows.end(), samples.begin() + begin, samples.begin() + end);
      };
      first_[t] = static_cast<std::uint32_t>(n_rows_ + colours.samples.size());
      append(atlas.colours(), colours.samples);
      append(atlas.slopes(), colours.slopes);
    }
  }
  n_rows_ += colours.samples.size();
  fill_ = atlas.n_fills();
  colours.first = first_;
  colours.parts = atlas.parts();
  return colours;
}

} // namespace kerf::scene
