#pragma once

/// What a plane cuts off a body.

#include "tests/support/clipped_box.h"
#include "tests/support/placed.h"

#include <bit>

namespace kerf::support {

/// Volume [m^3] on the lower side of a plane that has cut the body, from the triangles of the copies whose nodes lie
/// there.
inline double volume_below(const Body& body, const Plane& plane) {
  const auto complex = grid::build_complex(body.grid, body.cuts);
  const auto surface = surface::build_surface(body.grid, body.cuts, complex);
  double six_volumes = 0;
  for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
    const grid::Copy& copy = complex.copies[surface.copies[i]];
    const auto node = body.grid.nodes(copy.cell)[std::countr_zero(unsigned(copy.nodes))];
    const auto& [a, b, c] = surface.triangles[i];
    if (plane.height(body.grid.position(node)) < 0)
      six_volumes += surface.rest[a].dot(surface.rest[b].cross(surface.rest[c]));
  }
  return six_volumes / 6;
}

} // namespace kerf::support
