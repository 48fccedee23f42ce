#pragma once

/// Which normals a triangle mesh is shaded with.
///
/// Around a vertex, triangles that share an edge are shaded as one smooth surface if they have the same label and their
/// normals differ by at most the crease angle. Each such fan gives the vertex one normal: the mean of its triangles'
/// normals, weighted by area and by the angle at the vertex. So the rim of a cut stays sharp, while the skin and each
/// cut are smooth. Known limit: triangles are only joined by shared vertex indices, not by equal positions.

#include "base/vec.h"

#include <cstdint>
#include <span>
#include <vector>

namespace kerf::render {

/// A vertex as one fan of triangles sees it.
struct ShadedVertex {
  std::uint32_t vertex = 0; ///< index into the positions
  std::uint16_t label = 0;  ///< of the fan
  Vec3 normal = {0, 0, 1};  ///< unit, outward
};

struct ShadedMesh {
  std::vector<ShadedVertex> vertices;
  std::vector<Triangle> triangles; ///< indices into `vertices`; in the order of the input
};

constexpr double default_crease_angle = 50; ///< [degrees]

/// Splits vertices along creases [degrees] and label borders. An empty `labels` means 0 everywhere.
ShadedMesh shade(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                 std::span<const std::uint16_t> labels, double crease_angle = default_crease_angle);

} // namespace kerf::render
