#pragma once

/// Where a blade will go in a cell, before it has been there. It is taken to go on as it came: in the plane nearest to
/// what it has swept in the cell and to where it has cut edges around it, all at rest.
///
/// That is taken as certain where no node and no point of the skin lies nearer to the plane than twice what strays
/// farthest from it, and more where the blade has not come far yet (of what lies right in it, where nothing strays, the
/// predicates know the side), where what is cut already is parted by it, and where each of the two parts has a node.
/// Where the blade turns, it goes on in the surface of the second degree nearest to these points and to what it has swept
/// around the cell, from which less strays.
/// Cells are parted one by one, but share what they part: so one that is to have a front has to divide its faces as
/// those beside it do, as far as they divide them at all, and may leave nothing that hangs together with hardly
/// anything (shreds.h). Where a blade turns at once or a body swings, a cell so stays whole rather than parted in
/// a wrong place.

#include "cut/cell_at_plane.h"
#include "cut/recut.h"

#include <map>
#include <optional>

namespace kerf::cut {

/// Whether a cut may come farther: then it matters on which side nodes that lie near its course will be. Where it ends, as
/// a mesh does, any side will do that others agree on.
enum class Ahead { goes_on, ends };

/// The front of a cut that goes on through a cell as it came, and has passed nothing yet; none where that is not
/// certain. `pieces`: what the blade has swept in the cell, rest frame [m]; add_around(points) adds where it has been
/// around the cell.
std::optional<grid::Front> front_ahead(const grid::Solid& solid, grid::CellId c, const std::vector<Polygon>& pieces,
                                       grid::CutLabel label, Ahead ahead, FunctionRef<void(Points&)> add_around);

/// The cell and those that share a node with it, as far as faces lead to them.
std::vector<grid::CellId> cells_around(const grid::Grid& grid, grid::CellId c);

/// Does a plane, or do these pieces [rest frame, m], lie along a front, so that what has swept there moves it on?
bool is_along(const grid::Front& front, const Plane& plane, double h);
bool is_along(const grid::Front& front, const std::vector<Polygon>& pieces, double h);

using FrontsOfCells = std::map<grid::CellId, grid::Front>;

/// Can the cell have this front, if others have those of `begun`?
bool fits_in(const grid::Solid& solid, const grid::Front& front, const FrontsOfCells& begun);

/// Does the front still say how its cell is to be parted? Until its own blade has come between the cell's nodes, also
/// where that goes on otherwise.
bool is_ahead(const grid::Solid& solid, const grid::Front& front);

/// What keeps apart what a front that its blade did not follow has parted, where it is not to part it any more: of the
/// segments ahead that the blade has left whole, those between copies that have moved apart too far to be one again
/// (are_near, sides.h), cut where the front's plane crosses them. The crack has run there. None where a shred would
/// come free (shreds.h): that is joined, however far. None either where no corners are joined, but skin alone goes over
/// to the side on which the blade has left it.
SweepCuts cuts_between_gaping(const grid::Solid& solid, const grid::Front& front, const Points& x);

} // namespace kerf::cut
