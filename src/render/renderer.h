#pragma once

/// Images of bodies, their revealed faces and the tools that cut and hold them.
///
/// Passes: the depths seen from the key light (shadow map); the solids, shaded in linear light at twice the
/// resolution in each direction; ambient occlusion from their depths; the average of each 2 x 2 block over the
/// background, in sRGB. The lights stand in the frame of the camera, so that what it sees is lit.
/// Limits: opaque surfaces; one light casts shadows; the shadow map spans the whole scene, so a piece far away
/// makes the shadows of all others coarser.

#include "render/batch.h"
#include "render/camera.h"
#include "render/drawn.h"
#include "render/image.h"
#include "render/look.h"

#include <memory>

namespace kerf::render {

class Renderer {
 public:
  /// Makes a GL context; throws ParameterError if the camera cannot see, DataError without OSMesa.
  Renderer(const Camera& camera, const Look& look);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// What there is to draw of a scene as it is now. Throws as collect().
  Batch prepare(const DrawnScene& scene) const { return collect(camera_, look_, scene); }
  /// Draws it; the same input gives the same bytes. Any thread may, one at a time.
  Image draw_batch(const Batch& batch) const;
  Image draw(const DrawnScene& scene) const { return draw_batch(prepare(scene)); }

 private:
  struct Passes;
  Camera camera_;
  Look look_;
  std::unique_ptr<Passes> passes_;
};

} // namespace kerf::render
