#pragma once

/// Where surfaces end inside cells (grid/fronts.h): the cells that a disc or a rectangle passes in part, and how far.
///
/// Of each cell that the shape's plane meets, and that has one copy, though not of what cuts would part (Cuts::joined),
/// what of the material lies in the plane is clipped with the shape; the part that is left of it is how far the cut has
/// come. The shape is taken larger by the lag of fronts, as elements are too stiff there. Cells are parted once a vertex
/// of theirs opens (openings.h).
///
/// Only shapes that are flat and have an end: meshes and blades that move leave those of advance.h.

#include "cut/cut_surface.h"

namespace kerf::cut {

/// Ascending; with the corners at `x` [m]. What the surface cuts must be cut. Cells whose fronts it only moves on are
/// among them. As faces: they tell where the surface has come, too.
std::vector<grid::Front> find_fronts(const CutSurface& surface, const grid::Solid& solid, const Points& x,
                                     bool as_faces);

} // namespace kerf::cut
