#pragma once

/// Where surfaces end inside cells (grid/fronts.h): the cells that a disc or a rectangle passes in part, and how far.
///
/// Of each cell that the shape's plane meets, and that has one copy, though not of what cuts would part (Cuts::joined),
/// what of the material lies in the plane is clipped with the shape; the part that is left of it is how far the cut has
/// come. The shape is taken larger by the lag of fronts, as elements and springs are too stiff there. Cells are parted once a vertex
/// of theirs opens (openings.h).
///
/// Only shapes that are flat and have an end: meshes and blades that move leave those of advance.h.

#include "cut/cut_surface.h"

namespace kerf::cut {

/// Where cuts may end (also advance.h).
enum class Fronts {
  at_faces,    ///< with the last cell that they part
  of_elements, ///< inside cells (grid/fronts.h)
  of_springs,  ///< likewise, with the lag of springs and lattices
  of_points    ///< likewise, and each front tells where its cut has come (grid::Front::come)
};

/// By how much a cut whose front goes on in this direction (of any length) seems too short [cubes].
double lag(Fronts fronts, const Vec3& ahead);
/// The most that it can be.
double most_lag(Fronts fronts);

/// Ascending; with the corners at `x` [m]. What the surface cuts must be cut. Cells whose fronts it only moves on are
/// among them.
std::vector<grid::Front> find_fronts(const CutSurface& surface, const grid::Solid& solid, const Points& x,
                                     Fronts fronts);

} // namespace kerf::cut
