#pragma once

/// Which edges that can be cut a sweep meets in the current configuration (thesis §2.3.3).
///
/// Method: an uncut edge between two material nodes is one current segment, from the real corner of its lower node to
/// that of its upper node; an edge of the skin that no blade has cut is the one from its material node to the skin,
/// among the corners of that node's copy; and the segments of the skin in faces and cells (grid/skeleton.h) are met as
/// edges are, so that where a cut meets the skin is found, and not inferred. It is cut when an odd number of the
/// sweep's triangles cross it, by the exact predicates of geometry/predicates.h; boxes keep most pairs away from them.
/// The normal is pulled back to rest (target.h).
///
/// Who cuts a body often keeps boxes around its edges (edge_boxes.h) and hands them over, fitted to the corners'
/// places: then the time goes with the area that is cut. Without them every edge is looked at. The result is the same,
/// bit by bit, but for edges and segments of the skin that reach further from their block than four times the longest
/// edge of the body.
///
/// A body that moves is met in relative motion (moving_edge.h): what a blade sweeps in successive steps leaves no gap
/// for an edge to slip through, and material that moves through a resting blade is cut.

#include "cut/blade.h"
#include "cut/edge_boxes.h"
#include "grid/solid.h"

#include <map>
#include <span>

namespace kerf::cut {

/// Where all items of some cells are [m] (grid/skeleton.h); others are at the origin.
using SkinPlaces = std::map<grid::CellId, std::array<Vec3, grid::skeleton::n_items>>;

struct SweepCuts {
  std::vector<grid::EdgeCut> cuts;               ///< ordered by edge
  std::vector<grid::SkinCut> of_skin;            ///< ordered by segment
  std::size_t n_double_crossings = 0;            ///< edges and segments crossed 2, 4, ... times: left uncut
  std::vector<grid::EdgeCut> later = {};         ///< of edges that another label has cut before, ordered by edge
  std::vector<grid::SkinCut> later_of_skin = {}; ///< ordered by segment
};

/// Puts more behind what there is.
void append(SweepCuts& all, const SweepCuts& more);

/// The edges that `sweep` (triangles [m], world frame) cuts, when the corners are at `x` [m, world frame, one a
/// corner]. Where an edge is crossed 3, 5, ... times, the crossing nearest to its lower node is kept. Throws
/// NumericalError when a corner is not at a finite position.
SweepCuts cut_edges(std::span<const std::array<Vec3, 3>> sweep, const grid::Solid& solid, const Points& x,
                    grid::CutLabel label, const EdgeBoxes* boxes = nullptr);

/// The edges that a blade cuts on its path through a step in which the corners moved from `x_before` to `x`, and points
/// of the skin from where they are with those, or from `places_before` in cells that are among them.
SweepCuts cut_edges(const BladePath& path, const grid::Solid& solid, const Points& x_before, const Points& x,
                    grid::CutLabel label, const EdgeBoxes* boxes = nullptr, const SkinPlaces* places_before = nullptr);

} // namespace kerf::cut
