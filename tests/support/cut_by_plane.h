#pragma once

/// What a plane cuts off a body.

#include "tests/support/clipped_box.h"
#include "tests/support/placed.h"

#include <bit>

namespace kerf::support {

/// A point of the copy's material: one of its nodes, else of its points of the skin [m].
inline Vec3 point_in(const Body& body, const grid::Copy& copy) {
  return grid::item_point(body, copy.cell, std::countr_zero(copy.items()));
}

/// Volume [m^3] on the lower side of a plane that has cut the body, from the triangles of the copies whose material
/// lies there.
inline double volume_below(const Body& cut, const Plane& plane) {
  const Body body = with_copies(cut);
  const auto surface = surface::build_surface(body);
  double six_volumes = 0;
  for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
    const grid::Copy& copy = body.complex.copies[surface.copies[i]];
    const auto& [a, b, c] = surface.triangles[i];
    if (plane.height(point_in(body, copy)) < 0)
      six_volumes += surface.rest[a].dot(surface.rest[b].cross(surface.rest[c]));
  }
  return six_volumes / 6;
}

} // namespace kerf::support
