#pragma once

/// Where the vertices that a cut makes in faces and cells lie at rest (thesis §2.4.3, figure 2.15).
///
/// A cut edge gives a cut plane: its edge vertex and the normal of the cutting surface there. Face, inside the body:
/// (a) one plane, the face's centre projected onto it (a front ends here); two planes, (b) the middle of the Bezier
/// curve of edge vertices and the planes' intersection where they meet smoothly, (c) that intersection where they are
/// sharp; (d), (e) later cuts of a face already split project the vertex onto the new planes, within the planes of each
/// earlier cut. Cell, inside the body: the point nearest its centre that minimises the squared distances to all planes
/// [GH97]; later cuts of a cell already split project it, in the same way. The skin: the input's planes are known all
/// at once and give the quadric's minimum; that vertex never moves again (the thesis lets the skin jump: §2.8). Where
/// blades cut at the skin, a cell is a polyhedron (grid/skeleton.h), and cuts have vertices of their own in its sides
/// and in the cell, placed in the same way below the skin; in a triangle of the skin halfway between two cuts of its
/// sides. So a rim runs on the skin, from cut to cut of its segments, or to where cuts cross (crossing.h), and the skin
/// keeps its shape.
///
/// Departures: the thesis has one vertex a face and component, which cannot lie on the skin and on a cut below it; and
/// it projects plainly onto the new plane, which would bend an earlier cut that it does not meet at a right angle, and
/// move volume from one of its sides to the other; here what was flat stays flat, but for unfolding (unfold.h). A cell with
/// a front takes the quadric too, not the mean of its face vertices, which may lie beside the plane that is cut; fronts
/// of one label in different steps are (b) or (c) all the same. Cuts of several labels are no bent one: they are met in
/// their line or point, or one of them alone. A vertex never leaves its face or cell, so that every octant
/// (grid/material.h) has six positive tetrahedra: where all planes would meet outside, the weakest is given up, then the
/// next; where the strongest one leads outside, the vertex lies in it, or at the side. Limit: more than three planes in a
/// cell are met in the least-squares sense, and then a later cut may move what lies between earlier ones.

#include "grid/solid.h"

namespace kerf::surface {

struct Placement {
  /// Two planes that turn by more than this meet at a sharp edge: pi - theta of §2.4.3 [degrees].
  double sharp_angle = 45;
};

/// How many vertices were placed, but for those that were unfolded (unfold.h); how many of them the sides of their face
/// or cell, or the skin, held back from where their planes ask for them; and in how many cells a part has less than
/// nothing, which unfolding did not mend.
struct PlacementCounts {
  std::size_t n_placed = 0, n_clamped = 0, n_folded = 0;

  PlacementCounts& operator+=(const PlacementCounts& others) {
    n_placed += others.n_placed;
    n_clamped += others.n_clamped;
    n_folded += others.n_folded;
    return *this;
  }
  void archive(Archive& a) { a(n_placed, n_clamped, n_folded); }
};

/// Places the vertices in all faces and cells that are newly cut, or whose skin is newly parted beside a cut; then all
/// cuts are settled.
PlacementCounts place(grid::Solid& solid, const Placement& placement);
/// The same where it is known what has been cut since. Cells beside it whose vertices it had to move as well, since a
/// part would have had less than no material else, join the change, and their copies its reshaped ones.
PlacementCounts place(grid::Solid& solid, grid::CutChange& change, const Placement& placement);
/// The same for who builds all else anew, and needs no change.
inline PlacementCounts place(grid::Solid& solid, grid::CutChange&& change, const Placement& placement) {
  return place(solid, change, placement);
}

} // namespace kerf::surface
