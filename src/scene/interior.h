#pragma once

/// The inside of a body of the scene, and the colours of what cuts have revealed of it.

#include "base/timer.h"
#include "surface/surface.h"
#include "texture/atlas.h"

#include <memory>
#include <optional>

namespace kerf::scene {

struct BodyInterior {
  texture::Interior inside;
  std::unique_ptr<texture::Detail> detail = nullptr; ///< null: without small features
  std::optional<texture::Skin> skin = {};
  double relief = 0; ///< [m]
  texture::Atlas atlas;
};

/// Colours what is new of a surface.
void paint(BodyInterior& interior, const surface::Surface& surface, Timings& timings);

/// One colour a vertex of the surface, row by row: the mean of the samples of its triangles there; `otherwise` where it
/// has none.
std::vector<double> vertex_colours(const texture::Atlas& atlas, const surface::Surface& surface, const Vec3& otherwise);

} // namespace kerf::scene
