#pragma once

/// Fronts inside cells: what ties the copies of a cell in which a cut ends (Front, cuts.h).
///
/// Copies are parted cell by cell, so a cut could only be some whole cubes long. Where it ends inside a cell its copies
/// are parted all the same, as with phantom nodes (Rabczuk, Zi, Gerstenberger and Wall 2008, A new crack tip element
/// for the phantom-node method, Int. J. Numer. Meth. Engng 75), and the jump ends at the next cell, which is whole.
/// What the cut has not come to yet is made up for by springs of no length, one at each vertex at which the copies have
/// corners of their own, of stiffness
///
///     c E / (1 - nu^2) / h  A / 3  (1 - f) / f,
///
/// with A what of the front's plane lies in the cells around the vertex, weighted by its shape function, and f by how
/// much of it the cut opens the vertex (cut/openings.h). All cells in which copies part there share the spring. Seen from
/// the front what lies around a vertex is one spring of stiffness k_0 against opening, and to open by a part f of what it
/// does when it is free, k_0 + k has to be k_0 / f. The compliance of the body then grows linearly with what the cut
/// passes. Cells are parted as soon as one of their vertices opens, when its spring is stiffer than what it joins: so a
/// front that moves on gives and takes no energy at once, in a plane that leans too, in which it comes into cells in
/// which there is little to pass.
///
/// Elements cannot follow the root in which displacement ends at a front, and so are too stiff there, as if the cut
/// were shorter by a part of a cube. At f = 0 and f = 1 the springs play no part in that; c is such that it is as much
/// between: .59, for elements of either kind, any Poisson's ratio and a plane that lies anywhere. For a front along the
/// grid it is then the same to .02 cubes, in planes that lean by any angle to .1. Who finds fronts lets the cut go on by
/// that much (front_lag).
///
/// The lattice has no ties, but counts steps ahead of a front in part (lattice/lines.h); phyxels see what of the plane
/// has been cut (Front::come), with a lag of their own (pba::front_lag).
///
/// A front is provisional: when its blade has come between the cell's nodes, the cell is parted as that has cut it
/// (complex.h), and copies may be joined again. Those that have moved apart too far for that stay apart, if that leaves no
/// shred: the cell is cut between them, in the front's plane (cut/course.h).
///
/// What else is cut may leave a third part of the cell, of skin without a node. That is no front: it is held to what it
/// belongs to, by springs as stiff as its own material is: stiffer ones would do no more, and conjugate gradients would
/// feel them.
///
/// Departs from the source, in which the jump vanishes at the front by the shape functions of the element: these need
/// the front's shape in the cell, and another integration for each.

#include "base/function_ref.h"
#include "grid/solid.h"

namespace kerf::grid {

/// By how much a cut whose front goes on in this direction (of any length) seems too short to elements [cubes]: .25
/// along the grid, .235 else, as measured on beams and on discs of any tilt.
double front_lag(const Vec3& ahead);
/// The most that it can be.
constexpr double most_front_lag = 0.25;
/// To springs, and to lattices, times that: measured on openings of penny-shaped cuts, 2.3 and 2, and of an edge crack, 2.
constexpr double lag_of_springs = 2;

/// Between two corners at one node.
struct Tie {
  CornerId a, b;
  double length; ///< its spring's stiffness over E / (1 - nu^2) [m]
};

/// The copies that fronts alone part in some cells, in their order: none in those without a front, or through which
/// cuts have come meanwhile.
std::vector<std::array<CopyId, 2>> tied_copies(const Solid& solid, const CellComplex& complex,
                                               std::span<const CellId> cells);

/// Between them, in their order; none in crumbs, which are rigid (crumbs.h).
std::vector<Tie> ties(const Solid& solid);

/// Moves mass between corners that are tied, for explicit steps: the heavier one of two gives at most a 16th of its own
/// to those that have less than is `enough` [kg]. As they have one place at rest, the total, its centre and moments stay
/// in the rest shape. Parts of skin that ties alone hold have corners whose mass fades faster than the stiffness of the
/// part, and would vibrate the faster the thinner it is. More than is enough for that would be a weight that the ties of
/// such a part cannot bear.
void share_mass(std::span<const Tie> ties, FunctionRef<double(CornerId)> enough, std::vector<double>& mass);

/// How stiff ties are.
enum class TieStiffness {
  of_fronts,
  of_explicit_steps ///< soften()
};

/// Shortens ties so that at no corner their stiffness, E / (1 - nu^2) = `modulus` [Pa] times the sum of their lengths,
/// is more than its mass times `square_frequency` [1/s^2]. Corners that hold hardly any mass, and fronts that have just
/// come into a cell, would let bodies vibrate up to six times faster. With 2 (c / h)^2 for elements and half of it for
/// springs, c the speed of pressure waves, they do not let them vibrate faster by more than a twentieth and a tenth
/// beyond what the copies do. Where that makes ties too soft, before a quarter of the cell is passed, a front acts as
/// if it were up to .22 cubes further on, of springs .35.
void soften(std::vector<Tie>& ties, double modulus, double square_frequency, FunctionRef<double(CornerId)> mass);

} // namespace kerf::grid
