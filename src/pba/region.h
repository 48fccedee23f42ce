#pragma once

/// Where the material of a cut body is, by its octants (grid/material.h), so that whatever is sampled agrees with mass,
/// volume and surface of the body.

#include "grid/solid.h"

namespace kerf::pba {

/// A part of the material: its centroid [m] and its volume [m^3].
struct Crumb {
  Vec3 centre;
  double volume;
};

/// The material in parts no wider than `size` [m]: cubes of uncut cells, else tetrahedra of octants. Their volumes sum
/// to the body's.
std::vector<Crumb> crumbs(const grid::Solid& solid, double size);

/// The box around the material [m].
Box bounds(const grid::Solid& solid);

} // namespace kerf::pba
