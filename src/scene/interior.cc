#include "scene/interior.h"

namespace kerf::scene {

void paint(BodyInterior& interior, const surface::Surface& surface, Timings& timings) {
  const ScopedTimer timer(timings, "colour");
  interior.atlas.fill(
    {surface.rest, surface.triangles, surface.labels},
    {&interior.inside, interior.detail.get(), interior.skin ? &*interior.skin : nullptr, interior.relief});
}

std::vector<double> vertex_colours(const texture::Atlas& atlas, const surface::Surface& surface,
                                   const Vec3& otherwise) {
  Points sums(surface.rest.size(), Vec3::Zero());
  std::vector<int> counts(surface.rest.size(), 0);
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    if (atlas.first()[t] == texture::Atlas::none)
      continue;
    const std::size_t n = atlas.parts()[t], first = atlas.first()[t];
    const std::array<std::size_t, 3> at = {first, first + texture::n_samples(static_cast<int>(n)) - 1, first + n};
    for (int i = 0; i < 3; ++i) {
      const auto& [red, green, blue] = atlas.colours()[at[i]];
      sums[surface.triangles[t][i]] += Vec3(red, green, blue) / 255;
      ++counts[surface.triangles[t][i]];
    }
  }
  std::vector<double> rows;
  for (std::size_t v = 0; v < sums.size(); ++v) {
    const Vec3 colour = counts[v] > 0 ? Vec3(sums[v] / counts[v]) : otherwise;
    rows.insert(rows.end(), colour.data(), colour.data() + 3);
  }
  return rows;
}

} // namespace kerf::scene
