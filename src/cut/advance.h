#pragma once

/// How far moving blades have come in cells that they have not parted: the fronts that they leave (grid/fronts.h).
///
/// A cell is parted along the plane in which the blade will go through it, where that is certain (course.h); else it
/// stays whole until it is cut. A blade that rests while material moves across it does not tell where it goes, unless
/// it has come into the cell so. Another blade that goes on in a front's plane moves it on as its own does; but blades
/// move no fronts that surfaces have left which cut at once.
///
/// What the blade sweeps is drawn onto a raster in that plane, where a point that is passed twice counts once; what
/// leaves the plane by a quarter of a cube does not count. As physics are too stiff at a front, what is drawn is taken
/// larger by the lag of fronts, and so reaches on into the next cells. The part of the section of plane and material
/// that it covers is how far the cut has come. Cells are parted once a vertex of theirs opens (openings.h), into some
/// of which the front has not come by then. Where it has come, without that lag, is told as the hull of what has been
/// swept since it was told last, once a front has come on by a twentieth of a cube.
///
/// Cells in which cuts wait (pending.h) get no front before they are cut; those beside them are asked again then.
///
/// Errors: a texel is .04 cubes wide; within a cell the map of its copy is taken as affine. A blade that turns leaves
/// the fronts that it had, until it comes between the nodes of their cells: then these are parted as it has cut them.

#include "base/function_ref.h"
#include "cut/course.h"
#include "cut/edge_boxes.h"
#include "cut/fronts.h"
#include "cut/openings.h"
#include "cut/pending.h"
#include "cut/raster.h"

#include <set>

namespace kerf::cut {

class SweptPieces;

class Advance {
 public:
  explicit Advance(const Fronts fronts, const Ahead ahead = Ahead::goes_on) : fronts_(fronts), ahead_(ahead) {}

  /// What a blade sweeps while the corners go from x_before to x [m], to which `boxes` are fitted.
  void sweep(const BladePath& path, const grid::Solid& solid, const Points& x_before, const Points& x,
             const EdgeBoxes& boxes, grid::CutLabel label);
  /// What an open mesh cuts at once, with the corners at x.
  void sweep(const geometry::TriangleMesh& mesh, const grid::Solid& solid, const Points& x, const EdgeBoxes& boxes,
             grid::CutLabel label);

  /// The fronts that have begun or moved on since it was asked last, ascending; where nothing is left to part, or
  /// several cuts join what they part (Cuts::joined), cells are forgotten. To be asked when what the blades have met
  /// is cut.
  std::vector<grid::Front> take(const grid::Solid& solid, const PendingCuts& pending);

  void archive(Archive& a) { a(cells_, touched_, touched_before_); }

 private:
  struct Cell {
    grid::CutLabel label = 1;
    std::vector<Polygon> pieces = {}, at_rest = {}; ///< of strips of a blade that moves, and rests, rest frame [m];
                                                    ///< until there is a front
    Raster section = {}, swept = {};                ///< from then on
    OfVertices whole = {};                          ///< of the section, weighted by the shape functions, in texels
    AroundFront around = {};
    Points fresh = {}; ///< around what has been swept since the front was told last, rest frame [m]
    int n_fresh = 0;   ///< texels of that which had not been before

    /// A piece near the front's plane.
    void add_fresh(const grid::Front& front, double h, const Polygon& piece, int n_new);
    std::vector<Points> take_fresh(const grid::Front& front, double h);
    void archive(Archive& a) { a(label, pieces, at_rest, section, swept, whole, around, fresh, n_fresh); }
  };

  void sweep(const SweptPieces& sweep, const grid::Solid& solid, const EdgeBoxes& boxes, grid::CutLabel label, bool rests);
  void add(const grid::Solid& solid, grid::CellId c, const Polygon& piece, grid::CutLabel label, bool rests);
  std::optional<grid::Front> front_in(const grid::Solid& solid, grid::CellId c, grid::CutLabel label) const;
  void add_around(const grid::Solid& solid, grid::CellId c, grid::CutLabel label, Points& points) const;
  bool can_begin(const grid::Solid& solid, grid::CellId c) const;
  Cell follow(const grid::Solid& solid, grid::Front& front) const;
  void come_to(const grid::Solid& solid, const Cell& cell, grid::Front& front) const;
  struct Outcome;
  Outcome outcome(const grid::Solid& solid, grid::CellId c, FunctionRef<bool(grid::CellId)> waits) const;
  Outcome begun(const grid::Solid& solid, grid::CellId c, grid::CutLabel label) const;
  class Stand;
  std::vector<grid::Front> begin(const grid::Solid& solid, Stand& stand, FunctionRef<bool(grid::CellId)> waits,
                                 std::set<grid::CellId>& later);
  void move(const grid::Solid& solid, Stand& stand, std::vector<grid::Front>& fronts);
  void tell_where_they_have_come(const grid::Solid& solid, std::vector<grid::Front>& fronts);

  bool tell_faces() const { return fronts_ == Fronts::of_points; }

  Fronts fronts_;
  Ahead ahead_;
  std::map<grid::CellId, Cell> cells_;
  std::set<grid::CellId> touched_, touched_before_; // in which blades have swept since fronts were taken; before that
};

} // namespace kerf::cut
