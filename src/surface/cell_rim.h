#pragma once

/// The vertex of a cell that lies on the rim of a cut (rim.h).

#include "surface/rim.h"
#include "surface/view.h"

#include <functional>
#include <optional>

namespace kerf::surface {

struct RimVertex {
  Vec3 p;               ///< of the cuts [m]
  grid::SkinPoint skin; ///< as it is from now on
};

/// Calls f(triangle) for each triangle of the skin in a cell, of its fan of whole spokes [m].
void for_each_skin_triangle(const grid::Solid& solid, const View& view,
                            const std::function<void(const std::array<Vec3, 3>&)>& f);

/// Does a rim pass through the cell, from vertex to vertex in its faces?
bool rim_passes(const grid::Solid& solid, const View& view);

/// On the rim that passes through the cell, whose faces have their vertices already; along the cut from where the skin
/// bends, as far as gives the cell the volume that it had before any cut. Nothing where no such place is near.
std::optional<RimVertex> place_on_rim(const grid::Solid& solid, const View& view);

} // namespace kerf::surface
